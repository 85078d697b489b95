// Presets: job parameters under a name. The built-in ones are one for each kind of material.

#include "server/presets.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

std::string origin_of(bool built_in, bool stored) {
    return stored ? (built_in ? "changed" : "own") : "built-in";
}

json view_of(const NamedRecord& record, bool stored) {
    json view = json::parse(record.json);
    view["id"] = record.id;
    view["origin"] = origin_of(find_preset(built_in_presets(), record.id) != nullptr, stored);
    return view;
}

json find_view(App& app, const std::string& id) {
    if (const auto own = app.store().presets.find(id)) {
        return view_of(*own, true);
    }
    const NamedRecord* built_in = find_preset(built_in_presets(), id);
    if (built_in == nullptr) {
        throw HttpProblem(404, "no-such-preset", "there is no preset of that id");
    }
    return view_of(*built_in, false);
}

std::string text_in(const json& body, const char* key, std::size_t longest) {
    const auto found = body.find(key);
    if (found == body.end() || found->is_null()) {
        return {};
    }
    if (!found->is_string() || found->get_ref<const std::string&>().size() > longest) {
        throw HttpProblem(422, "bad-field",
                          fmt::format("{}: must be a text of up to {} bytes", key, longest));
    }
    return found->get<std::string>();
}

// Throws HttpProblem, geometry::Error.
NamedRecord record_from(App& app, const std::string& id, const json& body) {
    constexpr std::size_t kLongestId = 64;
    const auto is_plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
    };
    if (id.empty() || id.size() > kLongestId || !std::all_of(id.begin(), id.end(), is_plain)) {
        throw HttpProblem(422, "bad-field", "id: must be 1 to 64 of a-z, 0-9, -, _ and .");
    }
    constexpr std::size_t kLongestName = 200;
    constexpr std::size_t kLongestText = 2000;
    const json params = body.value("params", json::object());
    app.parts().check_params(dump_json(params));
    const std::string name = text_in(body, "name", kLongestName);
    const json record = {{"name", name.empty() ? id : name},
                         {"description", text_in(body, "description", kLongestText)},
                         {"params", params}};
    return {id, dump_json(record)};
}

json all_presets(App& app) {
    std::vector<NamedRecord> own = app.store().presets.list();
    json list = json::array();
    for (const NamedRecord& built_in : built_in_presets()) {
        const auto changed = std::find_if(own.begin(), own.end(),
                                          [&](const auto& each) { return each.id == built_in.id; });
        list.push_back(changed == own.end() ? view_of(built_in, false) : view_of(*changed, true));
    }
    for (const NamedRecord& record : own) {
        if (find_preset(built_in_presets(), record.id) == nullptr) {
            list.push_back(view_of(record, true));
        }
    }
    return {{"presets", std::move(list)}};
}

}  // namespace

Response list_presets(App& app, Request&) {
    return json_response(all_presets(app));
}

Response import_presets(App& app, Request& request) {
    const json body = parse_json(read_body(request, kMostBulkBytes));
    const auto list = body.is_object() ? body.find("presets") : body.end();
    if (list == body.end() || !list->is_array()) {
        throw HttpProblem(422, "bad-field", "presets: must be a list, as GET /presets shows it");
    }
    std::vector<NamedRecord> records;
    for (const json& entry : *list) {
        if (!entry.is_object()) {
            throw HttpProblem(422, "bad-field", "presets: must hold objects");
        }
        if (entry.value("origin", "") != "built-in") {
            records.push_back(record_from(app, text_in(entry, "id", 64), entry));
        }
    }
    app.store().presets.put_all(records);
    return json_response(all_presets(app));
}

Response show_preset(App& app, Request& request) {
    return json_response(find_view(app, request.capture("id")));
}

Response put_preset(App& app, Request& request) {
    const std::string& id = request.capture("id");
    const bool is_new = app.store().presets.put(record_from(app, id, read_json_object(request)));
    const bool built_in = find_preset(built_in_presets(), id) != nullptr;
    return json_response(find_view(app, id), is_new && !built_in ? 201 : 200);
}

Response delete_preset(App& app, Request& request) {
    const std::string& id = request.capture("id");
    if (!app.store().presets.remove(id)) {
        throw find_preset(built_in_presets(), id) != nullptr
            ? HttpProblem(409, "built-in", "a built-in preset stays; change it by PUT")
            : HttpProblem(404, "no-such-preset", "there is no preset of that id");
    }
    Response gone;
    gone.status = 204;
    return gone;
}

}  // namespace leafcutter::server
