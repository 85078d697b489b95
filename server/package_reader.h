// Reads back what a package says of its pieces, its sheets and how they were made, from the bytes
// of strips.json, layout.json and report.json. What is wrong with a file throws
// geometry::Error(BadFile) naming the file.

#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "fab/job_result.h"
#include "fab/layout.h"
#include "fab/strips/strip.h"

namespace leafcutter::server {

// Ids, families, outlines and marks: what cutting needs.
std::vector<fab::Piece> read_pieces(std::string_view strips_json);

// Ids, families and pieces.
std::vector<fab::Strip> read_strips(std::string_view strips_json);

// The file without all other pieces and without strips that have none left; numbers stay what they
// are, bit by bit.
std::string pick_pieces(std::string_view strips_json, const std::set<std::string>& ids);

std::vector<fab::Sheet> read_sheets(std::string_view layout_json);

// How a package was made.
struct PackageFacts {
    fab::InputFacts input;
    fab::JobParams params;
    std::string params_json;
    std::vector<fab::Material> materials;
    fab::MachineProfile machine;
};

PackageFacts read_facts(std::string_view report_json);

}  // namespace leafcutter::server
