// Reads back what a package says of its pieces and sheets, from the bytes of strips.json and
// layout.json.

#pragma once

#include <string_view>
#include <vector>

#include "fab/layout.h"
#include "fab/strips/strip.h"

namespace leafcutter::server {

// Ids, outlines and marks: what cutting needs. Throws geometry::Error(BadFile) naming the file and
// what is wrong with it.
std::vector<fab::Piece> read_pieces(std::string_view strips_json);

std::vector<fab::Sheet> read_sheets(std::string_view layout_json);

}  // namespace leafcutter::server
