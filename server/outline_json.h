// Outlines of remnants and their holes as JSON.

#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "fab/strips/strip.h"

namespace leafcutter::server {

// [[x, y], ...] in mm, a simple polygon in either orientation; `path` is what messages call it.
// Throws geometry::Error(BadOption).
fab::Ring read_outline(const nlohmann::json& value, const std::string& path);

}  // namespace leafcutter::server
