// The harmonic map from coarse to fine: a decomposition is chosen and solved on a few thousand
// vertices, then carried up, a few Newton steps for each level.
//
// The homotopy class is fixed at the coarsest level, whose size is therefore part of the result.

#pragma once

#include <vector>

#include "geometry/context.h"
#include "geometry/pants/harmonic_map.h"
#include "geometry/pants/level.h"

namespace leafcutter::geometry {

// Levels of detail, finest first.
struct Hierarchy {
    struct Level {
        LinedSurface surface;
        VertexRings rings;  // Of `surface`.
        FlippedSurface flipped;
        std::vector<int> representative;  // Per vertex here: its vertex of the next level.
    };
    std::vector<Level> levels;
    int boundary_lines = 0;  // Lines of smaller number are boundary loops, the others cuts.
};

// `finest` is connected, simplicial and without edges that join a line to another or to itself
// across the surface. At most about `coarsest` vertices are left in the last level.
Hierarchy build_hierarchy(LinedSurface finest,
                          int boundary_lines,
                          std::size_t coarsest,
                          const Context& context);

struct FineMap {
    GraphMap map;  // On the finest level's own triangles.
    HarmonicMapReport report;
};

// From a map of the coarsest level's flipped surface, near its minimum.
FineMap refine_map(const Hierarchy& hierarchy, const GraphMap& coarse, const Context& context);

}  // namespace leafcutter::geometry
