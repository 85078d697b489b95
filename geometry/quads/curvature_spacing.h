// Grids with narrower strips where the surface bends: the paper's section 5.2, "Face(K)".

#pragma once

#include <vector>

#include "geometry/foliation.h"
#include "geometry/quads/chart_sampler.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

// Regraded copies of `even` with the same counts, each by another mean of the curvature over a
// leaf: over the levels for Spacing::Curvature, over the surface's area for Spacing::CurvatureArea.
// No width changes by more than a factor of 2. Which of them is best shows only when they are
// measured.
std::vector<CylinderGrid> curvature_grids(const Cylinder& chart,
                                          const CylinderGrid& even,
                                          const ChartSampler& sampler,
                                          Spacing spacing);

}  // namespace leafcutter::geometry
