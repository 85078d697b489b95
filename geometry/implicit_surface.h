// Evenly triangulated level sets of smooth functions. Internal to geometry.

#pragma once

#include <functional>

#include <Eigen/Core>

#include "geometry/types.h"

namespace leafcutter::geometry {

// The surface where `value` is 0 inside the box; `value` is negative inside the solid. Where the
// solid leaves the box through its bottom (z = low.z) the surface has a boundary there; through the
// other sides it doesn't leave.
struct ImplicitSurface {
    std::function<double(const Eigen::Vector3d&)> value;
    Eigen::Vector3d low;
    Eigen::Vector3d high;
    double finest_detail = 0.0;  // Everything about the solid is wider than this.
};

// About `faces` triangles, most of them nearly equilateral, vertices on the surface, faces outward.
TriangleMesh mesh_implicit_surface(const ImplicitSurface& surface, int faces);

}  // namespace leafcutter::geometry
