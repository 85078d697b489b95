// Consistent winding, and one fan of faces at each vertex. Internal to geometry.

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/edge_table.h"

namespace leafcutter::geometry {

// Turns faces around until neighbours agree; returns how many. Nothing is turned where they agree
// already. Of the two windings a closed component gets the one that faces outward, an open one the
// one that turns fewer faces.
//
// No edge has more than two sides. Throws Error(BadMesh, "not-orientable") naming an edge.
std::size_t orient(std::span<const Eigen::Vector3d> positions, std::vector<Triangle>& triangles);

// Gives each further fan of faces around a vertex a copy of its own, appended to `positions`;
// returns how many. `triangles` are oriented, no edge has more than two sides.
std::size_t split_touching_fans(std::vector<Eigen::Vector3d>& positions,
                                std::vector<Triangle>& triangles);

}  // namespace leafcutter::geometry
