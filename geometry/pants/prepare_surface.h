// Makes a surface fit for the graph-valued map: fine enough, round loops too, and no edge that
// joins two closed lines, or one to itself, across the surface.

#pragma once

#include <vector>

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/pants/level.h"

namespace leafcutter::geometry {

struct PreparedSurface {
    LinedSurface surface;  // The given vertices first, then those of splits.
    int boundary_lines = 0;
    int cut_lines = 0;  // Numbered after the boundary lines.
};

// `boundary_loops` are all of them; `cuts` name closed loops as FoliationOptions::loops does.
// Throws Error(BadOption) for cuts that are no disjoint simple closed curves inside the surface.
PreparedSurface prepare_surface(const TriangleMesh& mesh,
                                const std::vector<std::vector<int>>& boundary_loops,
                                const std::vector<std::vector<int>>& cuts,
                                Refinement refinement,
                                const Context& context);

}  // namespace leafcutter::geometry
