// The four corners of a disk: where its boundary turns most, or as given.

#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/types.h"

namespace leafcutter::geometry {

// Corners as indices into the boundary loop, ascending.
using LoopCorners = std::array<int, 4>;

// Chooses four corners on `loop` (surface to the left, at least 4 vertices). First the four places
// of highest geodesic turning, smoothed over 1/40 of the loop and at least a tenth of it apart; if
// one of them turns less than 25 degrees, four equal arcs at the phase with most turning.
LoopCorners choose_corners(const TriangleMesh& mesh, std::span<const int> loop);

// The places of four given vertices.
// Throws Error(BadOption, "bad-corners") unless they are four different vertices of `loop`.
LoopCorners locate_corners(std::span<const int> loop, const std::array<int, 4>& vertices);

// Length of `loop` up to each of its vertices, then the whole: loop size + 1 entries.
std::vector<double> arc_lengths(const TriangleMesh& mesh, std::span<const int> loop);

}  // namespace leafcutter::geometry
