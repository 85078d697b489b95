// What to cut again, as JSON: the same for files and the API.

#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "fab/strips/strip.h"
#include "server/recut.h"

namespace leafcutter::server {

// [[x, y], ...] in mm, a simple polygon in either orientation; `path` is what messages call it.
// Throws geometry::Error(BadOption).
fab::Ring read_outline(const nlohmann::json& value, const std::string& path);

// {"pieces": ["W12.1", ...], "sheet": {"width_mm", "height_mm"}, "remnant": outline, "material":
// id}; all but the pieces optional. "name" is left to others. Throws geometry::Error(BadOption).
RecutWishes wishes_from_json(const nlohmann::json& body);

}  // namespace leafcutter::server
