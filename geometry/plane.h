// Vectors and rings in the plane.

#pragma once

#include <cmath>
#include <span>

#include <Eigen/Core>

namespace leafcutter::geometry {

// z of the cross product: positive where b turns left of a.
inline double turn_of(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// From a to b, in radians, counter-clockwise, within +-pi.
inline double angle_between(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return std::atan2(turn_of(a, b), a.dot(b));
}

// Positive if the ring runs counter-clockwise.
inline double signed_area(std::span<const Eigen::Vector2d> ring) {
    double twice = 0.0;
    for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
        twice += turn_of(ring[i] - ring[0], ring[i + 1] - ring[0]);
    }
    return twice / 2.0;
}

}  // namespace leafcutter::geometry
