// The store itself: how long what is kept, and its backups.

#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/json_body.h"
#include "server/retention.h"

namespace leafcutter::server {

using nlohmann::json;

Response show_retention(App& app, Request&) {
    return json_response(retention_to_json(retention_of(app.store().settings)));
}

Response change_retention(App& app, Request& request) {
    const Retention wanted =
        retention_from_json(read_json_object(request), retention_of(app.store().settings));
    put_retention(app.store().settings, wanted);
    app.housekeeper().wake();
    return json_response(retention_to_json(wanted));
}

Response list_backups(App& app, Request&) {
    json list = json::array();
    for (const auto& [name, bytes] : app.store().list_backups()) {
        list.push_back({{"name", name}, {"bytes", bytes}});
    }
    return json_response({{"backups", std::move(list)}});
}

Response make_backup(App& app, Request&) {
    const Retention retention = retention_of(app.store().settings);
    const std::string name = app.store().back_up(static_cast<std::size_t>(retention.backups_kept));
    return json_response({{"name", name}}, 201);
}

}  // namespace leafcutter::server
