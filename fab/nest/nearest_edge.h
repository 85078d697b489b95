// Where a point is nearest to a part's outline.

#pragma once

#include <optional>

#include <Eigen/Core>

#include "fab/nest/part.h"

namespace leafcutter::fab {

struct Foot {
    double distance = 0.0;                             // Below 0 inside.
    Eigen::Vector2d normal = Eigen::Vector2d::Zero();  // Outwards, of length 1.
    Eigen::Vector2d point = Eigen::Vector2d::Zero();
};

// The point of the outline that is nearest to `from`, both about the part's origin; nothing if it
// is `reach` away or more. Same bits on every machine.
std::optional<Foot> foot_of(const TurnedPart& part, const Eigen::Vector2d& from, double reach);

}  // namespace leafcutter::fab
