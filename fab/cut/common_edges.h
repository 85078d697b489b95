// Edges that two contours share are cut once.
//
// Where outlines lie a kerf apart, the beam's ways round them coincide. Such stretches become one
// path for both, the middle of the two; what is left of the contours becomes open paths.

#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "fab/cut/cut_program.h"

namespace leafcutter::fab {

struct SharedContours {
    std::vector<CutPath> paths;

    // Per path: the contours that it is a part of, the second the same as the first but for a
    // common edge.
    std::vector<std::pair<std::size_t, std::size_t>> owners;

    // The first path comes before the second: common edges of a contour before the rest of it, so
    // that no edge is cut between pieces that are loose already.
    std::vector<std::pair<std::size_t, std::size_t>> before;

    double common_mm = 0.0;
};

// How far two ways of the beam may lie apart to be one. Each piece's edge moves by half of it.
inline constexpr double kCommonEdgeMm = 0.02;

// `contours` are closed, counter-clockwise, simple, and don't cross each other by more than
// kCommonEdgeMm. Contours that share nothing come out as they are.
SharedContours share_edges(const std::vector<CutPath>& contours);

}  // namespace leafcutter::fab
