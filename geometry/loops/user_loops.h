// Loops that a user gives by a few vertices.

#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/context.h"
#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

// Joins each vertex of a list to the next, and the last to the first, by the shortest way along
// edges that keeps clear of the boundary, of other loops and of the loop's own ways before. Returns
// simple closed vertex cycles, disjoint from each other and from the boundary, in the order given.
//
// Throws Error(BadOption) with the number of the loop: "loop-vertices" for fewer than three
// vertices or ones that don't exist, "loop-not-simple" for a vertex given twice, "loops-meet" for
// one in two loops, "loop-at-boundary" for one on the boundary, "loop-blocked" where there is no
// way.
std::vector<std::vector<int>> close_loops(const VertexRings& rings,
                                          std::span<const Eigen::Vector3d> positions,
                                          std::span<const std::vector<int>> given,
                                          const Context& context);

}  // namespace leafcutter::geometry
