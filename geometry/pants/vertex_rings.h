// Edges and vertex rings of a triangle mesh in flat arrays, for the graph-valued map.

#pragma once

#include <vector>

#include "geometry/half_edges.h"

namespace leafcutter::geometry {

// One neighbour of a vertex.
struct RingSlot {
    int neighbour = 0;
    int edge = 0;          // Mesh edge.
    bool forward = false;  // The mesh edge runs from the vertex to the neighbour.
    int link = -1;         // Mesh edge that joins this neighbour to the next slot's; -1: a gap.
    bool link_forward = false;  // It runs from this neighbour to the next.
};

struct MeshEdge {
    int from = 0;
    int to = 0;
    int half_edge = 0;
};

// Slots of vertex v are slots[begin[v]] to slots[begin[v + 1] - 1], counter-clockwise; a boundary
// vertex's ring starts and ends at its two boundary edges.
struct VertexRings {
    std::vector<MeshEdge> edges;
    std::vector<int> edge_of_half_edge;
    std::vector<int> begin;
    std::vector<RingSlot> slots;
};

// Every vertex has one ring: the mesh is manifold, without unused vertices.
VertexRings build_vertex_rings(const HalfEdges& half_edges, int vertex_count);

// The same with edges numbered as given: one number for both half-edges of an edge, 0 to their
// count.
VertexRings build_vertex_rings(const HalfEdges& half_edges,
                               int vertex_count,
                               std::vector<int> edge_of_half_edge);

}  // namespace leafcutter::geometry
