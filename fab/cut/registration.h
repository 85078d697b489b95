// Lays a burnt contour onto the outline that was planned: by a rotation and a shift, nothing else.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "fab/strips/strip.h"

namespace leafcutter::fab {

// From sheet coordinates into a piece's own.
struct RigidMotion {
    double angle_rad = 0.0;
    Eigen::Vector2d shift = Eigen::Vector2d::Zero();  // After the rotation.

    Eigen::Vector2d apply(const Eigen::Vector2d& point) const;
};

struct Registration {
    RigidMotion motion;
    Ring contour;          // As moved.
    double miss_mm = 0.0;  // The farthest that a corner of one lies from the edge of the other.
};

// The ring moved inward by half the kerf; the largest one if it falls apart, empty if nothing
// stays. Counter-clockwise.
Ring without_kerf(const Ring& ring, double kerf_mm);

// What a beam of that width leaves of a piece planned as `outline`: narrow notches are filled.
Ring as_burnt(const Ring& outline, double kerf_mm);

// The best of the motions in `starts`, each brought to the least squares of the distances of
// corners from the planned edge. `starts` is not empty, both rings have three points or more.
Registration lay_onto(const Ring& contour,
                      const Ring& planned,
                      const std::vector<RigidMotion>& starts);

// Motions that bring the rings' centres and their main directions together, both ways round, and
// for shapes without a main direction more of them.
std::vector<RigidMotion> starts_by_shape(const Ring& contour, const Ring& planned);

// What does not change when a ring is moved.
struct ShapeKey {
    double area_mm2 = 0.0;
    double perimeter_mm = 0.0;
    double spread_mm = 0.0;  // Root of the polar moment over the area.
};

ShapeKey shape_key(const Ring& ring);

// The point of the ring that is nearest to `point`.
Eigen::Vector2d nearest_on(const Ring& ring, const Eigen::Vector2d& point);

}  // namespace leafcutter::fab
