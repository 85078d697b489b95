// Outlines as the nesting engine sees them, and rigid motions of them. Lengths are millimetres.

#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fab/nest/rotations.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

// Rotates about the origin, then moves. Never mirrors.
struct Pose {
    double angle_deg = 0.0;
    Eigen::Vector2d offset = Eigen::Vector2d::Zero();
};

struct Box {
    Eigen::Vector2d low = Eigen::Vector2d::Zero();
    Eigen::Vector2d high = Eigen::Vector2d::Zero();

    Eigen::Vector2d size() const { return high - low; }
    bool near(const Box& other, double gap) const {
        return low.x() - gap <= other.high.x() && other.low.x() - gap <= high.x() &&
               low.y() - gap <= other.high.y() && other.low.y() - gap <= high.y();
    }
};

struct NestShape {
    Ring outline;
    double area_mm2 = 0.0;
    double diameter_mm = 0.0;  // Largest distance between two vertices.
    double width_mm = 0.0;     // Mean width of a band of this area and perimeter.
    Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
    std::vector<double> lying_deg;  // Rotations that lay the shape along x, best first.
    Rotations allowed_deg;
};

// `outline` is simple and has at least three vertices, in either orientation.
NestShape make_shape(const Ring& outline);

// Counter-clockwise.
Ring convex_hull(Ring points);

Box bounds(std::span<const Eigen::Vector2d> points);
Ring moved(const Ring& ring, const Pose& pose);

// The same outline; edges longer than `longest` in equal parts.
Ring subdivided(const Ring& ring, double longest);

// A rotation with which the outline fits into width x height, or none. Exact for convex hulls:
// tries every direction in which an edge of the hull lies along an axis, and the fine steps
// between.
std::optional<double> fitting_angle(const NestShape& shape,
                                    const Eigen::Vector2d& extent,
                                    const Rotations& allowed_deg);

}  // namespace leafcutter::fab
