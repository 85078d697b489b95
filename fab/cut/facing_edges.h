// Edges of different rings that run along each other.

#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "fab/strips/strip.h"

namespace leafcutter::fab {

// An edge of a ring, or the corner that it starts at.
struct RingSpot {
    std::size_t contour = 0;  // Into the rings.
    std::size_t index = 0;
};

struct FacingOptions {
    double apart_mm = 0.0;  // At most, along all of the stretch that they have in common,
    double least_mm = 0.0;  // which is at least so long.
};

// Every pair once, in order. The edges of a pair run against each other, as those of neighbours do
// whose rings run the same way round.
std::vector<std::pair<RingSpot, RingSpot>> facing_edges(std::span<const Ring> rings,
                                                        const FacingOptions& options);

}  // namespace leafcutter::fab
