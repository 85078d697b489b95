// JSON in and out at the edge, within limits: 256 kB, 32 levels, no key twice; output that is valid
// whatever bytes a client once sent.

#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "server/http/request.h"

namespace leafcutter::server {

constexpr std::int64_t kMostJsonBytes = 262144;
constexpr std::int64_t kMostBulkBytes = 4 << 20;  // Of an import.

// Throws HttpProblem (400).
nlohmann::json parse_json(std::string_view text);

std::string dump_json(const nlohmann::json& value);

// The whole body, up to `most` bytes. Throws HttpProblem (413).
std::string read_body(const Request& request, std::int64_t most);

// A member that is text. Throws HttpProblem (422) if it is anything else; text_field() also if
// there is none.
std::string text_field(const nlohmann::json& object, const char* key);
std::string text_field_or(const nlohmann::json& object,
                          const char* key,
                          const std::string& otherwise);

// The body as a JSON object; an empty one if there is none. Throws HttpProblem.
nlohmann::json read_json_object(const Request& request);

}  // namespace leafcutter::server
