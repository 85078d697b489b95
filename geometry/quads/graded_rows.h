// Spacing::Curvature and CurvatureArea where cylinders are joined: rows alone are graded, as
// columns go on from one cylinder into the next.

#pragma once

#include <vector>

#include "geometry/context.h"
#include "geometry/quads/conforming_mesh.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

// Per part of `even` levels of its rows by which each for itself comes closer to the surface; none
// where none do. Ends are measured without what lies beyond them.
std::vector<std::vector<double>> graded_rows(const JoinedMesh& even,
                                             const GridOptions& options,
                                             const Context& context);

// Whether quads lie closer to the surface in `graded` than in `even`, measured in the whole: the
// largest distance is smaller and the mean no larger, or by very little.
struct CameCloser {
    std::vector<char> parts;  // Each.
    bool whole = false;       // Nowhere farther than the farthest was.
};
CameCloser compare_distances(const JoinedMesh& even,
                             const JoinedMesh& graded,
                             const Context& context);

}  // namespace leafcutter::geometry
