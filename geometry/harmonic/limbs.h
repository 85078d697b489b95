// Long limbs: a conformal chart shrinks a limb of length L and circumference C by exp(-2 pi L / C),
// beyond the resolution of numbers for L > 6 C. Such parts are opened by weights that pull along
// the limb more than around it; being positive, they keep the embedding theorems.

#pragma once

#include <vector>

#include "geometry/harmonic/chart_map.h"
#include "geometry/laplacian.h"

namespace leafcutter::geometry {

// Per vertex the distance along edges to where the chart's scale is still ordinary; 0 outside
// limbs.
std::vector<double> limb_depths(const ChartMap& map);

// Makes `edges` heavier where they run along a limb.
void pull_along_limbs(std::vector<WeightedEdge>& edges,
                      const ChartMap& map,
                      const std::vector<double>& depths);

}  // namespace leafcutter::geometry
