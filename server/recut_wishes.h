// What to cut again, as JSON: the same for files and the API.

#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "server/recut.h"

namespace leafcutter::server {

// {"pieces": ["W12.1", ...], "sheet": {"width_mm", "height_mm"}, "remnant": outline, "material":
// id}; all but the pieces optional. "name" is left to others. Throws geometry::Error(BadOption).
RecutWishes wishes_from_json(const nlohmann::json& body);

}  // namespace leafcutter::server
