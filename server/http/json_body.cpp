#include "server/http/json_body.h"

#include <set>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

HttpProblem bad_json(const std::string& why) {
    return {400, "bad-json", "the JSON body: " + why};
}

// Refuses depth and repeated keys while the parser runs: copying or writing a very deep value would
// overflow the stack later.
class Watch {
public:
    bool operator()(int depth, json::parse_event_t event, const json& parsed) {
        constexpr int kDeepest = 32;
        if (depth > kDeepest) {
            throw bad_json("nested deeper than 32 levels");
        }
        if (event == json::parse_event_t::object_start) {
            keys_.emplace_back();
        } else if (event == json::parse_event_t::object_end) {
            keys_.pop_back();
        } else if (event == json::parse_event_t::key) {
            const std::string key = parsed.get<std::string>();
            if (!keys_.back().insert(key).second) {
                throw bad_json(fmt::format("the key \"{}\" comes twice", key));
            }
        }
        return true;
    }

private:
    std::vector<std::set<std::string>> keys_;
};

}  // namespace

json parse_json(std::string_view text) {
    Watch watch;
    try {
        return json::parse(text, std::ref(watch));
    } catch (const json::exception& error) {
        throw bad_json(error.what());
    }
}

std::string dump_json(const json& value) {
    return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string read_body(const Request& request, std::int64_t most) {
    if (request.body.bytes > most) {
        throw HttpProblem(413, "too-large",
                          fmt::format("the body may have {} bytes at most", most));
    }
    std::string body(static_cast<std::size_t>(request.body.bytes), '\0');
    std::size_t filled = 0;
    while (filled < body.size()) {
        const std::size_t size = request.body.read({body.data() + filled, body.size() - filled});
        if (size == 0) {
            throw RequestAborted();
        }
        filled += size;
    }
    return body;
}

std::string text_field(const json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_string()) {
        throw HttpProblem(422, "bad-field", fmt::format("{}: must be a string", key));
    }
    return found->get<std::string>();
}

std::string text_field_or(const json& object, const char* key, const std::string& otherwise) {
    return object.contains(key) ? text_field(object, key) : otherwise;
}

json read_json_object(const Request& request) {
    const std::string type = request.header("content-type").value_or("application/json");
    if (type.find("json") == std::string::npos) {
        throw HttpProblem(415, "content-type", "send application/json");
    }
    const std::string body = read_body(request, kMostJsonBytes);
    json value = body.empty() ? json::object() : parse_json(body);
    if (!value.is_object()) {
        throw bad_json("it must be an object");
    }
    return value;
}

}  // namespace leafcutter::server
