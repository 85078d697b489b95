// Grids with narrower strips where the surface bends: the paper's section 5.2, "Face(K)".

#pragma once

#include <vector>

#include "geometry/foliation.h"
#include "geometry/quads/chart_sampler.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

// Levels with the same counts as the even ones, each by another mean of the curvature over a leaf:
// over the levels for Spacing::Curvature, over the surface's area for Spacing::CurvatureArea. No
// width changes by more than a factor of 2. Which of them are best shows only when they are
// measured.
struct CurvatureLevels {
    std::vector<std::vector<double>> rows;
    std::vector<std::vector<double>> cols;  // None where columns are shifted into one another.
};

CurvatureLevels curvature_levels(const Cylinder& chart,
                                 const CylinderGrid& even,
                                 const ChartSampler& sampler,
                                 Spacing spacing);

}  // namespace leafcutter::geometry
