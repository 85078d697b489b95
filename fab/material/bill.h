// Bill of materials: what a job takes of each material, and what that costs.

#pragma once

#include <string>
#include <vector>

namespace leafcutter::fab {

struct JobResult;

struct BillLine {
    std::string material;  // Id.
    std::string name;
    int sheets = 0;
    int pieces = 0;
    double strips_area_mm2 = 0.0;  // Of the outlines on the sheets.
    double sheets_area_mm2 = 0.0;
    double weight_g = 0.0;    // Of the strips.
    double engrave_mm = 0.0;  // Every pass counted, as with the other two.
    double score_mm = 0.0;
    double cut_mm = 0.0;
    double machine_s = 0.0;
    double cost = 0.0;     // Of the sheets, in the material's currency; 0 if no price is known.
    std::string currency;  // Empty without a price.
};

struct Bill {
    std::vector<BillLine> lines;  // Materials in the order of weft, warp; one if they share it.
};

// Reads layout, programs, pieces and materials of `job`; pieces that fit on no sheet don't count.
Bill make_bill(const JobResult& job);

}  // namespace leafcutter::fab
