// How much two parts overlap, as the search counts it.

#pragma once

#include "fab/nest/part.h"

namespace leafcutter::fab {

// 0 if `a`, moved by (dx, dy), and `b` have no point in common, as far as floats can tell; else a
// positive measure that falls as they part: equation (1) to (4) of the paper named in part.h, a
// sum over pairs of inscribed circles. Same bits on every machine.
float pair_loss(const TurnedPart& a, const TurnedPart& b, float dx, float dy);

// 0 if the box of `part`, moved by (x, y), lies in [0, width] x [0, height].
float sheet_loss(const TurnedPart& part, float x, float y, float width, float height);

}  // namespace leafcutter::fab
