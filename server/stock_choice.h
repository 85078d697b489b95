// Sheets of the store in job parameters: nesting.stock may be "store", for all that is at hand, or
// name entries of the store among those that it describes itself.

#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "server/store/records.h"

namespace leafcutter::server {

// Whether the parameters name any sheet of the store.
bool names_stock(const nlohmann::json& params);

// The parameters with every name replaced by what it stands for: what is at hand and in nobody's
// plan. Throws geometry::Error(BadOption) for a name that is not there.
nlohmann::json with_stock(nlohmann::json params, const std::vector<StockRecord>& stock);

}  // namespace leafcutter::server
