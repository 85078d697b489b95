// A round jug of genus 5: five handles about its belly, and a neck that ends blindly. Like the
// botijo of the literature, thin parts on a thick one.

#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>

#include "geometry/implicit_surface.h"

namespace leafcutter::testing {

inline geometry::TriangleMesh make_jug(int faces) {
    using Eigen::Vector3d;
    const auto blend = [](double a, double b, double width) {
        const double near = std::max(width - std::abs(a - b), 0.0) / width;
        return std::min(a, b) - 0.25 * width * near * near;
    };
    const auto value = [=](const Vector3d& p) {
        constexpr int kHandles = 5;
        constexpr double kSector = 2.0 * std::numbers::pi / kHandles;
        double solid = p.norm() - 1.0;
        // Every handle looks the same from its own sector.
        const double angle = std::remainder(std::atan2(p.y(), p.x()), kSector);
        const double radius = std::hypot(p.x(), p.y());
        const double out = radius * std::cos(angle) - 1.08;
        const double ring = std::hypot(out, p.z()) - 0.45;
        solid = blend(solid, std::hypot(ring, radius * std::sin(angle)) - 0.12, 0.12);
        const double high = std::clamp(p.z(), 0.0, 1.6);
        return blend(solid, (p - Vector3d(0.0, 0.0, high)).norm() - 0.22, 0.15);
    };
    return geometry::mesh_implicit_surface({value, {-1.9, -1.9, -1.2}, {1.9, 1.9, 2.0}, 0.1},
                                           faces);
}

}  // namespace leafcutter::testing
