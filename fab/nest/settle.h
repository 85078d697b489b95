// Whether items have room on given sheets: overlaps are minimised until there are none.

#pragma once

#include <cstdint>
#include <vector>

#include "fab/nest/board.h"
#include "fab/nest/compaction.h"
#include "geometry/context.h"

namespace leafcutter::fab {

struct Settled {
    bool found = false;
    std::vector<Position> positions;
    std::int64_t evaluations = 0;
};

// `start`: where the items lie; those of bin -1 are put anywhere first. All rooms of the plan may
// be filled. Two searches with different random numbers; the first of them that finds room in an
// equal number of evaluations wins, so that the result does not depend on threads.
Settled settle(const BoardPlan& plan,
               const std::vector<Position>& start,
               const CompactionOptions& options,
               const geometry::Context& context);

}  // namespace leafcutter::fab
