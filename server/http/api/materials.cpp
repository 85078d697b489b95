// The built-in materials.

#include <nlohmann/json.hpp>

#include "fab/material/material.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/api/views.h"
#include "server/http/problem.h"

namespace leafcutter::server {

Response list_materials(App&, Request&) {
    nlohmann::json materials = nlohmann::json::array();
    for (const fab::Material& material : fab::built_in_materials()) {
        materials.push_back(material_json(material));
    }
    return json_response({{"materials", materials}});
}

Response show_material(App&, Request& request) {
    const fab::Material* material =
        fab::find_material(fab::built_in_materials(), request.capture("id"));
    if (material == nullptr) {
        throw HttpProblem(404, "no-such-material", "there is no material of that id");
    }
    return json_response(material_json(*material));
}

}  // namespace leafcutter::server
