// Ways along the edges of a surface.

#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

// The edge that joins two vertices. Throws Error(SelfCheck, "no-such-edge") if none does.
int find_edge(const VertexRings& rings, int a, int b);

// Per vertex the length of the shortest edge path from any of `sources`; infinite where none leads.
std::vector<double> path_lengths(const VertexRings& rings,
                                 std::span<const Eigen::Vector3d> positions,
                                 std::span<const int> sources);

}  // namespace leafcutter::geometry
