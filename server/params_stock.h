// Sheets at hand and sets of rotations as JSON, in and out (docs: nesting.stock, nesting.rotation).

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "fab/job_params.h"

namespace leafcutter::server {

// [{"id", "material"?, "width_mm" and "height_mm" | "outline": [[x, y], …], "holes"?, "defects"?,
// "keep_out"?: lists of outlines, "quantity"?: null: as many as wanted, "cost"?}, …]
//
// Throws geometry::Error(BadOption) by full path, for what is no sheet and for an id that is there
// twice.
std::vector<fab::StockItem> read_stock(const nlohmann::json& value, const std::string& path);

// One such entry.
fab::StockItem read_stock_item(const nlohmann::json& entry, const std::string& path);

// The sheets of a file: such a list, or {"format": "leafcutter-stock/1", "stock": list} as packages
// hold it. Throws as above.
nlohmann::json stock_of_text(std::string_view text);

// "free", "0", "0,180", "0,90,180,270", or a list of angles and intervals [from, to] in degrees.
fab::Rotations read_rotations(const nlohmann::json& value, const std::string& path);
nlohmann::json rotations_to_json(const fab::Rotations& rotations);

}  // namespace leafcutter::server
