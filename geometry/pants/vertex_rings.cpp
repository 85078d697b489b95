#include "geometry/pants/vertex_rings.h"

#include <algorithm>
#include <utility>

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

std::vector<int> edge_numbers(const HalfEdges& half_edges) {
    std::vector<int> number(at(half_edges.size()), -1);
    int edges = 0;
    for (int h = 0; h < half_edges.size(); ++h) {
        if (!half_edges.is_first(h)) {
            continue;
        }
        number[at(h)] = edges;
        if (half_edges.twin_of(h) >= 0) {
            number[at(half_edges.twin_of(h))] = edges;
        }
        ++edges;
    }
    return number;
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
    return build_vertex_rings(half_edges, vertex_count, edge_numbers(half_edges));
}

VertexRings build_vertex_rings(const HalfEdges& half_edges,
                               int vertex_count,
                               std::vector<int> edge_of_half_edge) {
    VertexRings rings;
    rings.edge_of_half_edge = std::move(edge_of_half_edge);
    const auto last =
        std::max_element(rings.edge_of_half_edge.begin(), rings.edge_of_half_edge.end());
    rings.edges.resize(last == rings.edge_of_half_edge.end() ? 0 : at(*last) + 1);
    for (int h = 0; h < half_edges.size(); ++h) {
        if (half_edges.is_first(h)) {
            rings.edges[at(rings.edge_of_half_edge[at(h)])] = {half_edges.from_of(h),
                                                               half_edges.to_of(h), h};
        }
    }
    // Every edge is in the rings of its two ends.
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
