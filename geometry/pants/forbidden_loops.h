// Ways round the surface that no cylinder of a decomposition may go.

#pragma once

#include <set>
#include <span>
#include <vector>

#include "geometry/context.h"
#include "geometry/loops/holonomy.h"
#include "geometry/pants/hierarchy.h"
#include "geometry/pants/tree_word.h"

namespace leafcutter::geometry {

class ForbiddenLoops {
public:
    // `loops` are vertices of the finest level, each joined to the next, and the last to the first,
    // by a shortest way along edges. They may cross each other and themselves. `kept` are closed
    // lines of the finest level that every decomposition is told to have. Keeps the hierarchy by
    // reference.
    // Throws Error(BadOption), naming the loop: "loop-vertices" for fewer than three vertices or
    // ones that don't exist, "loop-not-essential" for one that can be drawn together to a point,
    // "loop-at-boundary" for one round a boundary loop, where there is always a cylinder,
    // "loop-kept" for one that goes the way of one of `kept`.
    ForbiddenLoops(const Hierarchy& hierarchy,
                   std::span<const std::vector<int>> loops,
                   std::span<const std::vector<int>> kept,
                   const Context& context);

    // Whether no cylinder of the map, solved on the coarsest level's flipped surface, goes the way
    // of one of the loops.
    bool allow(const GraphMap& map) const;

private:
    const Hierarchy::Level& level_;
    std::vector<Holonomy> holonomies_;  // Of the coarsest level's flipped surface.
    std::set<LoopTrace> forbidden_;
};

}  // namespace leafcutter::geometry
