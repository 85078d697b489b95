// Materials: the built-in ones and those that were added or changed here.

#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/material/material.h"
#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"
#include "server/material_json.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

struct Shelf {
    std::vector<fab::Material> stored;
    std::vector<fab::Material> all;
};

Shelf shelf_of(App& app) {
    Shelf shelf;
    shelf.stored = materials_from_records(texts_of(app.store().materials.list()));
    shelf.all = with_materials(fab::built_in_materials(), shelf.stored);
    return shelf;
}

// "built-in", "changed" (a built-in one was) or "own".
json view_of(const Shelf& shelf, const fab::Material& material) {
    const bool built_in = fab::find_material(fab::built_in_materials(), material.id) != nullptr;
    const bool stored = fab::find_material(shelf.stored, material.id) != nullptr;
    json view = material_to_json(material);
    view["origin"] = stored ? (built_in ? "changed" : "own") : "built-in";
    return view;
}

json view_of(const Shelf& shelf, const std::string& id) {
    const fab::Material* material = fab::find_material(shelf.all, id);
    if (material == nullptr) {
        throw HttpProblem(404, "no-such-material", "there is no material of that id");
    }
    return view_of(shelf, *material);
}

}  // namespace

Response list_materials(App& app, Request&) {
    const Shelf shelf = shelf_of(app);
    json materials = json::array();
    for (const fab::Material& material : shelf.all) {
        materials.push_back(view_of(shelf, material));
    }
    return json_response({{"materials", std::move(materials)}});
}

Response show_material(App& app, Request& request) {
    return json_response(view_of(shelf_of(app), request.capture("id")));
}

Response put_material(App& app, Request& request) {
    const std::string& id = request.capture("id");
    json body = read_json_object(request);
    body.erase("origin");  // As shown; what it is follows.
    const auto named = body.emplace("id", id);
    if (!named.second && *named.first != id) {
        throw HttpProblem(422, "bad-field", "id: must be the one of the address, or be left out");
    }
    const fab::Material material = material_from_json(body, "", shelf_of(app).all);
    const bool is_new = app.store().materials.put({id, dump_json(material_to_json(material))});
    const bool built_in = fab::find_material(fab::built_in_materials(), id) != nullptr;
    return json_response(view_of(shelf_of(app), id), is_new && !built_in ? 201 : 200);
}

Response import_materials(App& app, Request& request) {
    const json body = parse_json(read_body(request, kMostBulkBytes));
    const auto list = body.is_object() ? body.find("materials") : body.end();
    if (list == body.end() || !list->is_array()) {
        throw HttpProblem(422, "bad-field",
                          "materials: must be a list, as GET /materials shows it");
    }
    const Shelf shelf = shelf_of(app);
    std::vector<NamedRecord> records;
    for (std::size_t i = 0; i < list->size(); ++i) {
        json entry = (*list)[i];
        if (!entry.is_object()) {
            throw HttpProblem(422, "bad-field", fmt::format("materials[{}]: must be an object", i));
        }
        if (entry.value("origin", "") == "built-in") {
            continue;  // As shown: everybody has it.
        }
        entry.erase("origin");
        const fab::Material material =
            material_from_json(entry, fmt::format("materials[{}]", i), shelf.all);
        records.push_back({material.id, dump_json(material_to_json(material))});
    }
    app.store().materials.put_all(records);
    return list_materials(app, request);
}

Response delete_material(App& app, Request& request) {
    const std::string& id = request.capture("id");
    if (!app.store().materials.remove(id)) {
        const bool built_in = fab::find_material(fab::built_in_materials(), id) != nullptr;
        throw built_in ? HttpProblem(409, "built-in", "a built-in material stays; change it by PUT")
                       : HttpProblem(404, "no-such-material", "there is no material of that id");
    }
    Response gone;
    gone.status = 204;
    return gone;
}

}  // namespace leafcutter::server
