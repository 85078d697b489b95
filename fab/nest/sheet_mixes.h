// Which sheets to take: sequences to begin with, and mixes that cost less than what there is.

#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "fab/nest/sheet_start.h"

namespace leafcutter::fab {

// How many sheets of each kind.
using Mix = std::vector<int>;

// For each kind that there is no end of: the sheets of limited number that cost no more for their
// area, cheapest first, then that kind; behind it whatever else there is, for what fits on none of
// these. And the cheapest of them alone: remnants that would hardly be filled stay whole.
std::vector<std::vector<SheetRun>> first_offers(const SheetProblem& problem);

// Of the mixes that cost less than `kinds`, have at least `area` and did not fail before: the one
// with the largest area. Sheets for nothing are always in it. None if there is none.
std::optional<Mix> roomiest_cheaper_mix(const SheetProblem& problem,
                                        std::span<const std::size_t> kinds,
                                        double area,
                                        std::span<const Mix> failed);

// In the order in which they are to be filled.
std::vector<SheetRun> runs_of(const SheetProblem& problem, const Mix& mix);

}  // namespace leafcutter::fab
