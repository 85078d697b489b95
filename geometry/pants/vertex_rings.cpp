#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// The half-edge out of each vertex to start its ring from: the boundary one where there is one.
std::vector<int> ring_starts(const HalfEdges& half_edges, int vertex_count) {
    std::vector<int> start(at(vertex_count), -1);
    for (int h = 0; h < half_edges.size(); ++h) {
        int& of_vertex = start[at(half_edges.from_of(h))];
        if (of_vertex < 0 || half_edges.twin_of(h) < 0) {
            of_vertex = h;
        }
    }
    return start;
}

void number_edges(VertexRings& rings, const HalfEdges& half_edges) {
    rings.edge_of_half_edge.assign(at(half_edges.size()), -1);
    for (int h = 0; h < half_edges.size(); ++h) {
        if (!half_edges.is_first(h)) {
            continue;
        }
        const int edge = static_cast<int>(rings.edges.size());
        rings.edges.push_back({half_edges.from_of(h), half_edges.to_of(h), h});
        rings.edge_of_half_edge[at(h)] = edge;
        if (half_edges.twin_of(h) >= 0) {
            rings.edge_of_half_edge[at(half_edges.twin_of(h))] = edge;
        }
    }
}

RingSlot slot_along(const VertexRings& rings, int half_edge, int vertex) {
    RingSlot slot;
    slot.edge = rings.edge_of_half_edge[at(half_edge)];
    const MeshEdge& edge = rings.edges[at(slot.edge)];
    slot.forward = edge.from == vertex;
    slot.neighbour = slot.forward ? edge.to : edge.from;
    return slot;
}

void append_ring(VertexRings& rings, const HalfEdges& half_edges, int start) {
    const int vertex = half_edges.from_of(start);
    int h = start;
    do {
        RingSlot slot = slot_along(rings, h, vertex);
        const int across = HalfEdges::next(h);
        slot.link = rings.edge_of_half_edge[at(across)];
        slot.link_forward = rings.edges[at(slot.link)].from == slot.neighbour;
        rings.slots.push_back(slot);
        const int last = HalfEdges::previous(h);
        h = half_edges.twin_of(last);
        if (h < 0) {
            rings.slots.push_back(slot_along(rings, last, vertex));
        }
    } while (h >= 0 && h != start);
}

}  // namespace

VertexRings build_vertex_rings(const HalfEdges& half_edges, int vertex_count) {
    VertexRings rings;
    number_edges(rings, half_edges);
    rings.slots.reserve(rings.edges.size() * 2);
    rings.begin.reserve(at(vertex_count) + 1);
    for (const int start : ring_starts(half_edges, vertex_count)) {
        rings.begin.push_back(static_cast<int>(rings.slots.size()));
        append_ring(rings, half_edges, start);
    }
    rings.begin.push_back(static_cast<int>(rings.slots.size()));
    return rings;
}

}  // namespace leafcutter::geometry
