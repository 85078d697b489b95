// Closed integer cochains of a triangulated surface, by crossings with loops or arcs of triangles.
//
// A cochain has one value for each half-edge, antisymmetric across an edge, with sum zero round
// every triangle: +1 on a half-edge that the dual path leaves its triangle by, -1 where it enters.
//
// Tree and cotree after Eppstein, "Dynamic generators of topologically embedded graphs", SODA 2003.

#pragma once

#include <vector>

#include "geometry/half_edges.h"

namespace leafcutter::geometry {

using Cochain = std::vector<int>;

// A basis of the first integer cohomology of a closed connected surface: 2 x genus cochains.
std::vector<Cochain> cohomology_basis(const HalfEdges& edges, int vertex_count);

// The same, each with a cycle of vertices on which its value is 1 and all others' are 0: a basis of
// the first homology.
struct DualBasis {
    std::vector<Cochain> cochains;
    std::vector<std::vector<int>> cycles;  // Simple, along edges.
};
DualBasis dual_basis(const HalfEdges& edges, int vertex_count);

// Crossings with one arc of triangles that enters through the boundary loop of `from` and leaves
// through that of `to`; `loop_of_vertex` is -1 in the interior. Generates the cohomology of an
// annulus.
Cochain arc_cochain(const HalfEdges& edges,
                    const std::vector<int>& loop_of_vertex,
                    int from,
                    int to);

}  // namespace leafcutter::geometry
