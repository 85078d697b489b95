// Grids whose strips are as wide as the surface's bending allows: Spacing::Curvature and
// CurvatureArea. geometry/quads/README.md defines both.

#pragma once

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/quads/chart_sampler.h"
#include "geometry/quads/level_search.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

// A chart that is to be graded, its grid of even strips and what may change of it.
struct GradingWish {
    const Cylinder& chart;
    const ChartSampler& sampler;
    const CylinderGrid& even;
    Spacing spacing = Spacing::Curvature;
    bool half_sag_offset = true;
    MovableLevels movable;
};

// The grid with the same counts whose quads' largest distance to the surface is smallest, over the
// lengths of their leaves: for Curvature of those graded by curvature, for CurvatureArea with
// levels then moved one by one. Its mean distance is no larger than that of `even`, or 2 % where
// nothing else helps; `even` itself if none is better.
CylinderGrid graded_grid(const GradingWish& wish, const Context& context);

}  // namespace leafcutter::geometry
