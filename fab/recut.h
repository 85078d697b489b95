// Single pieces of a finished job cut again, on fresh sheets or on a remnant.

#pragma once

#include <string>
#include <vector>

#include "fab/job_result.h"
#include "fab/package/package.h"
#include "geometry/context.h"

namespace leafcutter::fab {

struct RecutInput {
    InputFacts input;  // Of the job.
    JobParams params;  // Nesting and output count.
    std::string params_json;
    MachineProfile machine;
    Material weft;  // With the sheets to cut from.
    Material warp;
    std::vector<Piece> pieces;  // Those wanted, with id, strip, family, outline and marks.
    Ring remnant;               // The one piece of material to cut from; empty: whole sheets.
};

struct RecutSummary {
    Package package;  // sheets/, layout.json, report.json, bill.csv, recut.html; no strips.json.
    int sheets = 0;
    int pieces = 0;
    double estimated_s = 0.0;
};

// Stages reported: "nest", "toolpath", "package". Outlines and marks are those of the input, bit by
// bit.
//
// Throws geometry::Error(BadOption) if pieces fit on no sheet, naming them, or if a remnant is to
// hold pieces of two materials; Cancelled.
RecutSummary recut(const RecutInput& input, const geometry::Context& context = {});

}  // namespace leafcutter::fab
