// Cuts a surface along the critical graph, the preimage of the nodes, into one piece per graph edge
// (section 3.4).

#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/foliation.h"
#include "geometry/pants/tree_word.h"
#include "geometry/pants/vertex_rings.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

struct Piece {
    TriangleMesh mesh;
    std::vector<int> source_vertex;   // Of the surface, or -1 on a cut.
    std::vector<int> critical_point;  // Of Sliced::critical_points, or -1 off the cuts.
    // The two boundary loops, surface to the left: at t = 0, then at t = the edge's weight.
    std::array<std::vector<int>, 2> loops;
};

struct Sliced {
    std::vector<Piece> pieces;                  // Per graph edge.
    std::vector<Eigen::Vector3d> three_prongs;  // Where three legs meet.
    std::vector<CriticalPoint> critical_points;
    // The critical graph: one curve from three-prong point to three-prong point each, or closed
    // (then the last point is the first).
    std::vector<std::vector<Eigen::Vector3d>> critical_arcs;
};

// No word of `map` is longer than 2. Throws Error(SelfCheck, "broken-cylinder") if a piece is not
// an annulus, "collapsed-edge" if nothing is mapped to a graph edge.
Sliced slice_surface(const TriangleMesh& mesh, const VertexRings& rings, const GraphMap& map);

}  // namespace leafcutter::geometry
