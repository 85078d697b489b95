// Triangles for polygons of any shape. Internal to geometry.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/edge_table.h"

namespace leafcutter::geometry {

// Appends corners - 2 triangles that cover the polygon, wound as it is.
//
// Ear clipping in the polygon's mean plane. A simple polygon, convex or not, is covered without
// overlap; one that crosses itself still gets corners - 2 triangles on its own edges. Takes
// O(corners * reflex corners) time.
//
// `corners` has at least 3 entries, no two neighbours equal.
void triangulate_polygon(std::span<const std::uint32_t> corners,
                         std::span<const Eigen::Vector3d> positions,
                         std::vector<Triangle>& triangles);

}  // namespace leafcutter::geometry
