// An order in which bands that bend alike come together: side by side they leave little between
// them.

#pragma once

#include <compare>
#include <cstddef>
#include <vector>

#include "fab/nest/board.h"

namespace leafcutter::fab {

struct BandBend {
    bool first_right = false;  // Bends to the right first, then to the left: an S's mirror image.
    // Radians for each unit of length, both halves of the band summed up: above 0 if they bend to
    // the same side, below 0 if not.
    double by = 0.0;

    auto operator<=>(const BandBend&) const = default;
};

// None of what is no band.
BandBend bend_of(const NestPart& part);

// All items by bend, in that many groups of about equal size; in each the longest ones first.
std::vector<std::size_t> by_bend(const BoardPlan& plan, std::size_t groups);

}  // namespace leafcutter::fab
