// Singular points near places where they are wanted (section 6: control over their positions).
//
// Where the three-prong points of a decomposition lie depends on its weights, continuously: a
// search over the logarithms of the weights, on the coarsest level, leads them as near as they get.
// Which decomposition is used decides what they can reach at all.

#pragma once

#include <span>
#include <vector>

#include "geometry/context.h"
#include "geometry/pants/coarse_maps.h"
#include "geometry/pants/hierarchy.h"

namespace leafcutter::geometry {

struct NearOptions {
    std::span<const int> wanted;  // Vertices of the finest level. Not empty.
    bool weights_are_fixed = false;
};

// The maps of solve_coarsest, the one that comes nearest first, then that of more even cells; and
// before them the same with weights that bring the points nearer. No weight is changed by more than
// a factor of about five.
// Throws Error(BadOption, "too-many-near") if there are more places than points.
std::vector<CoarseMap> nearest_maps(const Hierarchy& hierarchy,
                                    std::vector<CoarseMap> maps,
                                    const NearOptions& options,
                                    const Context& context);

}  // namespace leafcutter::geometry
