// How much two parts overlap, as the search counts it.

#pragma once

#include "fab/nest/part.h"

namespace leafcutter::fab {

// 0 if `a`, moved by (dx, dy), and `b` have no point in common, as far as floats can tell; else a
// positive measure that falls as they part: equation (1) to (4) of the paper named in part.h, a
// sum over pairs of inscribed circles. Same bits on every machine.
float pair_loss(const TurnedPart& a, const TurnedPart& b, float dx, float dy);

// 0 if the box of `part`, moved by `at`, lies in [0, room.x] x [0, room.y].
float sheet_loss(const TurnedPart& part, const Eigen::Vector2f& at, const Eigen::Vector2f& room);

}  // namespace leafcutter::fab
