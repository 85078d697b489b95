// Test cards as jobs: what is wanted, as JSON, and the package that it becomes.

#pragma once

#include <span>

#include <nlohmann/json_fwd.hpp>

#include "fab/material/material.h"
#include "server/queue/compute_runner.h"

namespace leafcutter::server {

// {"kind": "kerf"|"power", "material": ID, …}: see the API's description. `materials` are those
// that may be named.
//
// Throws geometry::Error(BadOption) naming the field.
ComputeOutput test_card_from(const nlohmann::json& wish, std::span<const fab::Material> materials);

// The same for the daemon: the built-in materials and those of the records.
ComputeOutput make_test_card(const std::string& wish_json,
                             const std::vector<std::string>& material_records);

}  // namespace leafcutter::server
