// What a drawing of lines encloses: common edges make the contours of several pieces one net.

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fab/nest/collision.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

struct PlanarFace {
    Ring ring;                       // Counter-clockwise.
    std::vector<std::size_t> lines;  // Those on its edge.
    int times = 1;                   // How often its edge is drawn, where that is least.
};

// The bounded faces of a drawing whose lines meet at their ends only, to a micrometre. Ends that
// face each other along one line over at most `bridge_mm` are joined; lines that lead nowhere, as
// lead-ins do, are on the edge of no face.
std::vector<PlanarFace> faces_of(std::span<const Segment> lines, double bridge_mm);

// True if the way from `before` over a gap to `after` is straight on and at most so long.
bool bridges(const Segment& before, const Segment& after, double most_mm);

}  // namespace leafcutter::fab
