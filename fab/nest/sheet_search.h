// Items on a mix of sheets: rectangles of several sizes, remnants, hides; each with a cost and a
// number. What counts: as few items left over as possible, then the least cost, then how much of
// the last sheet stays whole.

#pragma once

#include <cstdint>
#include <functional>

#include "fab/nest/compaction.h"
#include "fab/nest/sheet_plan.h"
#include "geometry/context.h"

namespace leafcutter::fab {

// The best layout found. `accept` decides on each better one before it counts (from the calling
// thread): the caller's proof; the first must pass, else Error(SelfCheck). A stop request ends the
// search early; Cancelled if there is no layout yet.
//
// The result depends on problem, seed and max_evaluations (if that is what ends it), not on
// threads.
SheetPacking search_sheets(const SheetProblem& problem,
                           const CompactionOptions& options,
                           const geometry::Context& context,
                           const std::function<bool(const SheetPacking&)>& accept);

}  // namespace leafcutter::fab
