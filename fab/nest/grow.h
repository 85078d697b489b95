// Outlines grown all around, and cut by one another: for the search, never less than exact.

#pragma once

#include <span>
#include <vector>

#include "fab/strips/strip.h"

namespace leafcutter::fab {

// At least all points within `by` of the ring or inside it, as one ring, counter-clockwise.
// `by` >= 0.
Ring grown(const Ring& ring, double by);

// The part of the box [low, high] that is outside of all `rings`, cut into simple rings by a grid
// of `cells` x `cells`.
std::vector<Ring> outside_of(std::span<const Ring> rings,
                             const Eigen::Vector2d& low,
                             const Eigen::Vector2d& high,
                             int cells);

}  // namespace leafcutter::fab
