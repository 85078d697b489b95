// The Reeb graph of a function on a surface, by a sweep, and the arcs that mesh edges run through.
//
// Exact: O(n log n + saddles x contour length). After M. Hajij, T. Dey, X. Li, "Segmenting a
// surface mesh into pants using Morse theory", Graphical Models 88 (2016).

#pragma once

#include <span>
#include <vector>

#include "geometry/pants/sweep_mesh.h"

namespace leafcutter::geometry {

struct ReebArc {
    int low = 0;  // Nodes.
    int high = 0;
    double low_value = 0.0;  // Function values at its two nodes.
    double high_value = 0.0;
};

// Vertices and edges are those of `mesh`. Nodes have one arc or three.
struct ReebGraph {
    SweepMesh mesh;
    std::vector<ReebArc> arcs;
    std::vector<int> node_vertex;     // Per node: the vertex it is at.
    std::vector<int> boundary_node;   // Per boundary loop: the end node that caps it.
    std::vector<int> arc_of_vertex;   // Regular vertices: their arc; nodes: -1.
    std::vector<int> node_of_vertex;  // -1 for regular vertices.
    // Per mesh edge (as VertexRings numbers them) the arcs it runs through, upwards from its lower
    // end. Edges that never reach past a saddle have one.
    std::vector<std::vector<int>> arcs_of_edge;
    std::vector<char> edge_runs_up;  // Per mesh edge: its `from` is the lower end.
};

// Sweeps the mesh that make_sweep_mesh() makes of the surface; see there.
ReebGraph build_reeb_graph(std::span<const std::array<int, 3>> triangles,
                           std::span<const double> values,
                           std::span<const std::vector<int>> boundary_loops,
                           std::span<const char> loop_is_low,
                           int turn = 0);

}  // namespace leafcutter::geometry
