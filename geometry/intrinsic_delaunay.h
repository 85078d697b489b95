// Intrinsic Delaunay triangulation of a surface: same vertices, edges flipped across the flat
// unfolding of their two triangles, so that every cotangent weight of an interior edge is
// non-negative.
//
// After Bobenko and Springborn, "A discrete Laplace-Beltrami operator for simplicial surfaces",
// 2007; needles are made harmless first as in Sharp and Crane, "A Laplacian for nonmanifold
// triangle meshes", SGP 2020.

#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/half_edges.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

// The values of two closed integer 1-cochains on a half-edge: by how much a multivalued function's
// lift rises more along it than its vertex values say. Antisymmetric; sums to zero round each
// triangle.
using Jump = std::array<int, 2>;

struct IntrinsicTriangulation {
    int vertex_count = 0;
    HalfEdges
        edges;  // Not simplicial: edges may join the same two vertices twice, or one to itself.
    std::vector<double> length;  // Per half-edge.
    std::vector<Jump> jump;      // Per half-edge.
    int flips = 0;
    std::vector<std::array<int, 2>> flip_log;  // The two half-edges of each flip, in order.
    double added_length = 0.0;  // By which every edge was made longer, so that no triangle is flat.
};

// `jump` has an entry for each half-edge of `edges`, or is empty, which means zero.
IntrinsicTriangulation intrinsic_delaunay(const TriangleMesh& mesh,
                                          const HalfEdges& edges,
                                          std::span<const Jump> jump = {});

// Takes the values of a closed cochain, one for each half-edge, back to the triangulation that was
// flipped into this one.
std::vector<double> undo_flips(const IntrinsicTriangulation& triangulation,
                               std::vector<double> values);

// Cotangent of the angle that faces `half_edge` in its triangle.
double facing_cotangent(const IntrinsicTriangulation& triangulation, int half_edge);

}  // namespace leafcutter::geometry
