// Weights and decompositions for cells of even area (the paper's first open problem, section 6).
//
// Cells of a grid have rows that are evenly wide on the surface, but the columns go through whole
// cylinders and on into the next. How much the cells' areas vary is then a matter of how large the
// cylinders' parts of the surface are for their circumferences and, within a leaf, of the conformal
// factor. Both depend on the weights.

#pragma once

#include <vector>

#include "geometry/context.h"
#include "geometry/pants/coarse_maps.h"
#include "geometry/pants/hierarchy.h"

namespace leafcutter::geometry {

// What a grid of so many cells would be like, without making it.
struct GridForecast {
    double variation = 0.0;   // Of cell areas: standard deviation over mean.
    double least_rows = 0.0;  // Of the cylinder that has fewest.
};

GridForecast forecast_grid(const Hierarchy::Level& level, const GraphMap& map, double cells);

// The maps of solve_coarsest, and before them the best two of them with weights that give the
// smallest variation found, least first. Cylinders keep three rows at least where they can.
// Descends along logarithms of weights, all at once, in shrinking steps.
std::vector<CoarseMap> even_maps(const Hierarchy& hierarchy,
                                 std::vector<CoarseMap> maps,
                                 double cells,
                                 const Context& context);

}  // namespace leafcutter::geometry
