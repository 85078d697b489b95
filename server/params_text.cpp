// Parameters as text: files and --set.

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/json_reader.h"
#include "server/params.h"

namespace leafcutter::server {

using nlohmann::json;

json parse_params_text(std::string_view text, const std::string& what) {
    constexpr int kDeepest = 16;
    std::vector<std::set<std::string>> keys;
    const json::parser_callback_t strict = [&](int depth, json::parse_event_t event, json& parsed) {
        if (depth > kDeepest) {
            refuse_param(what, "nested too deeply");
        }
        if (event == json::parse_event_t::object_start) {
            keys.emplace_back();
        } else if (event == json::parse_event_t::object_end) {
            keys.pop_back();
        } else if (event == json::parse_event_t::key) {
            const auto key = parsed.get<std::string>();
            if (!keys.back().insert(key).second) {
                refuse_param(key, "there twice");
            }
        }
        return true;
    };
    try {
        return json::parse(text, strict);
    } catch (const json::exception& error) {
        const std::string_view message = error.what();
        const auto detail = message.find("] ");
        refuse_param(what, "no JSON: " + std::string(detail == std::string_view::npos
                                                         ? message
                                                         : message.substr(detail + 2)));
    }
}

void set_param(json& params, std::string_view assignment) {
    const auto equals = assignment.find('=');
    const std::string path(assignment.substr(0, equals));
    if (equals == std::string_view::npos || path.empty()) {
        refuse_param("--set " + std::string(assignment), "must be a.b=VALUE");
    }
    json* place = &params;
    for (std::size_t begin = 0; begin <= path.size();) {
        const std::size_t end = std::min(path.find('.', begin), path.size());
        const std::string key = path.substr(begin, end - begin);
        if (key.empty()) {
            refuse_param(path, "not a path of keys parted by dots");
        }
        if (!place->is_null() && !place->is_object()) {
            refuse_param(path.substr(0, begin == 0 ? 0 : begin - 1), "must be an object");
        }
        place = &(*place)[key];
        begin = end + 1;
    }
    const std::string text(assignment.substr(equals + 1));
    json value = json::parse(text, nullptr, false);
    *place = value.is_discarded() ? json(text) : std::move(value);
}

}  // namespace leafcutter::server
