// The harmonic map from coarse to fine: a decomposition is chosen and solved on a few thousand
// vertices, then carried up, a few Newton steps for each level.
//
// The homotopy class is fixed at the coarsest level, whose size is therefore part of the result.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/cell_spread.h"
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

// A map of the coarsest level, solved.
struct CoarseMap {
    std::string name;  // Of the function or loops, and of the rule for weights.
    GraphMap map;
    HarmonicMapReport report;
    CellSpread spread;
    double unevenness = 0.0;   // Root mean square of the logarithm of cell area, over the surface.
    double loop_length = 0.0;  // Mean length of the leaves of F in all cylinders together.
    double score = 0.0;        // Of both; less is better.
};

struct CoarseOptions {
    PantsSource pants = PantsSource::Reeb;
    SweepFunction function = SweepFunction::Auto;
    std::optional<std::vector<double>> weights;
    int attempt = 0;  // Later ones start elsewhere.
};

// All that could be solved, best first. With automatic weights each decomposition is tried with the
// lengths of its parts and with equal weights.
// Throws Error(BadOption) for weights of the wrong number, and as pants_candidates does.
std::vector<CoarseMap> solve_coarsest(const Hierarchy& hierarchy,
                                      const CoarseOptions& options,
                                      const Context& context);

struct FineMap {
    GraphMap map;  // On the finest level's own triangles.
    HarmonicMapReport report;
};

FineMap refine_map(const Hierarchy& hierarchy, const CoarseMap& coarse, const Context& context);

}  // namespace leafcutter::geometry
