// Makes a chart one-to-one: no triangle flipped or flat.
//
// A piecewise linear harmonic map on an intrinsic triangulation is close to one-to-one, but nothing
// promises that no triangle of the surface as given is flipped. The ladder, each step only where
// the one before left a flipped triangle:
//   1. boundary coordinates are made monotone along their rails;
//   2. limbs shrunk beyond the resolution of numbers are opened (limbs.h), the rest held;
//   3. the vertices near flipped triangles are solved for again with positive weights, all others
//   held;
//   4. the same for the whole chart. A harmonic map with positive weights whose boundary is a
//   convex
//      polygon is an embedding (Tutte 1963, Floater 1997); so is one to an annulus with straight
//      boundaries and to a torus (Gortler, Gotsman, Thurston, "Discrete one-forms on meshes",
//      2006).

#pragma once

#include <vector>

#include "geometry/context.h"
#include "geometry/harmonic/chart_map.h"

namespace leafcutter::geometry {

// Consecutive boundary vertices whose image lies on one straight line of the chart.
struct Rail {
    std::vector<int> vertices;
    int axis = 0;         // Coordinate that must grow along the rail: 0 for g, 1 for f.
    bool closed = false;  // The last vertex is joined to the first, one period further on.
};

struct FlipReport {
    int flipped_as_solved = 0;
    bool opened_limbs = false;  // Step 2 found some.
    bool whole_chart = false;   // Step 4 was needed.
};

// Changes `map.gf` only. No interior edge of the surface joins two vertices of one rail. Boundary
// vertices are on rails, in every step at their present place on the other axis.
FlipReport make_bijective(ChartMap& map, const std::vector<Rail>& rails, const Context& context);

}  // namespace leafcutter::geometry
