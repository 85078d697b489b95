// A quad as the surface that is measured: bilinear between its corners a b c d.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

struct BilinearPatch {
    Eigen::Vector3d a;
    Eigen::Vector3d b;
    Eigen::Vector3d c;
    Eigen::Vector3d d;

    // u from a to b, v from a to d, both in [0, 1].
    Eigen::Vector3d at(double u, double v) const {
        return (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d;
    }
    double weft_length() const { return 0.5 * ((b - a).norm() + (c - d).norm()); }
    double warp_length() const { return 0.5 * ((d - a).norm() + (c - b).norm()); }
    // Middle lines: between the middles of opposite sides.
    Eigen::Vector3d weft_middle() const { return 0.5 * (b + c - a - d); }
    Eigen::Vector3d warp_middle() const { return 0.5 * (c + d - a - b); }
};

inline BilinearPatch patch_of(const QuadMesh& mesh, std::size_t quad) {
    const auto& corners = mesh.quads[quad];
    return {.a = mesh.vertices[static_cast<std::size_t>(corners[0])],
            .b = mesh.vertices[static_cast<std::size_t>(corners[1])],
            .c = mesh.vertices[static_cast<std::size_t>(corners[2])],
            .d = mesh.vertices[static_cast<std::size_t>(corners[3])]};
}

// Area of two triangles, split along a–c, as everywhere a grid of points stands for an area.
inline double split_area(const BilinearPatch& patch) {
    const Eigen::Vector3d diagonal = patch.c - patch.a;
    return 0.5 *
           ((patch.b - patch.a).cross(diagonal).norm() + diagonal.cross(patch.d - patch.a).norm());
}

inline double angle_between_deg(const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
    const double lengths = std::max(u.norm() * v.norm(), 1e-300);
    return std::acos(std::clamp(u.dot(v) / lengths, -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

}  // namespace leafcutter::geometry
