// The part of the surface that each grid cell stands for.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/foliation.h"
#include "geometry/quads/grid.h"

namespace leafcutter::geometry {

struct CellRegions {
    std::vector<double> area;                  // Per cell; the sum is the chart's area to rounding.
    std::vector<Eigen::Vector3d> vector_area;  // Per cell: area times normal, summed.
};

// Clips the triangles of the chart in (g, f) against the grid. O(triangles + pieces).
CellRegions cut_regions(const Cylinder& chart, const ChartGrid& grid);

}  // namespace leafcutter::geometry
