#include "geometry/pants/collapsible.h"

namespace leafcutter::geometry {
namespace {

// More neighbours than this in all and the merged vertex would be a hub.
constexpr int kMostNeighbours = 16;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

}  // namespace

CollapsibleMesh::CollapsibleMesh(std::span<const std::array<int, 3>> triangles, int vertex_count) {
    const HalfEdges edges = build_half_edges(triangles, vertex_count);
    sides_.resize(edges.from.size());
    out_.assign(at(vertex_count), -1);
    degree_.assign(at(vertex_count), 0);
    mark_.assign(at(vertex_count), 0);
    for (int h = 0; h < edges.size(); ++h) {
        side(h) = {edges.from_of(h), edges.twin_of(h)};
        int& out = out_[at(edges.from_of(h))];
        out = out < 0 || edges.twin_of(h) < 0 ? h : out;
        ++degree_[at(edges.from_of(h))];
        degree_[at(edges.to_of(h))] += edges.twin_of(h) < 0 ? 1 : 0;
    }
}

void CollapsibleMesh::look(int v) {
    ring_.clear();
    ++looks_;
    const int start = out_[at(v)];
    int h = start;
    closed_ = true;
    do {
        ring_.push_back({to_of(h), h});
        const int last = HalfEdges::previous(h);
        h = side(last).twin;
        if (h < 0) {
            ring_.push_back({side(last).from, -1});
            closed_ = false;
        }
    } while (h >= 0 && h != start);
    for (const CollapsibleEntry& entry : ring_) {
        mark_[at(entry.neighbour)] = looks_;
    }
}

// A vertex that loses a neighbour keeps a ring.
bool CollapsibleMesh::keeps_ring(int corner) const {
    return degree(corner) >= (on_boundary(corner) ? 3 : 4);
}

bool CollapsibleMesh::may_collapse(std::size_t slot) const {
    const std::size_t count = ring_.size();
    const int u = ring_[slot].neighbour;
    const int own = static_cast<int>(count);
    if (degree(u) + own > kMostNeighbours) {
        return false;
    }
    int facing = 0;
    if (closed_ || slot + 1 < count) {
        ++facing;
        if (!keeps_ring(ring_[(slot + 1) % count].neighbour)) {
            return false;
        }
    }
    if (closed_ || slot > 0) {
        ++facing;
        if (!keeps_ring(ring_[(slot + count - 1) % count].neighbour)) {
            return false;
        }
    }
    int shared = 0;
    const int start = out_[at(u)];
    int h = start;
    do {
        shared += mark_[at(to_of(h))] == looks_ ? 1 : 0;
        const int last = HalfEdges::previous(h);
        h = side(last).twin;
        if (h < 0) {
            shared += mark_[at(side(last).from)] == looks_ ? 1 : 0;
        }
    } while (h >= 0 && h != start);
    return shared == facing;
}

// Joins the two outer sides of a triangle that goes; `h` is its side between the two vertices that
// become one. Returns the outer side that starts at the kept vertex, or -1.
int CollapsibleMesh::close_triangle(int h, int kept) {
    const std::array<int, 2> inner{HalfEdges::next(h), HalfEdges::previous(h)};
    const std::array<int, 2> outer{side(inner[0]).twin, side(inner[1]).twin};
    const int corner = side(inner[1]).from;
    for (std::size_t k = 0; k < 2; ++k) {
        if (outer[k] >= 0) {
            side(outer[k]).twin = outer[1 - k];
        }
    }
    if (out_[at(corner)] == inner[1]) {
        out_[at(corner)] = outer[0];
    }
    --degree_[at(corner)];
    for (const int gone : {h, inner[0], inner[1]}) {
        side(gone).from = -1;
    }
    return outer[1] >= 0 && side(outer[1]).from == kept ? outer[1] : -1;
}

void CollapsibleMesh::collapse(int v, std::size_t slot) {
    const int u = ring_[slot].neighbour;
    std::array<int, 2> between{ring_[slot].half_edge, -1};  // v -> u and u -> v.
    if (closed_ || slot > 0) {
        const CollapsibleEntry& before = ring_[(slot + ring_.size() - 1) % ring_.size()];
        between[1] = HalfEdges::previous(before.half_edge);
    }
    for (const CollapsibleEntry& entry : ring_) {
        if (entry.half_edge >= 0) {
            side(entry.half_edge).from = u;
        }
    }
    std::array<int, 4> out{-1, -1, out_[at(u)], out_[at(v)]};
    degree_[at(u)] += degree(v) - 2;
    for (std::size_t k = 0; k < 2; ++k) {
        if (between[k] >= 0) {
            out[k] = close_triangle(between[k], u);
            --degree_[at(u)];
        }
    }
    int first = -1;
    for (const int h : out) {
        if (h >= 0 && side(h).from == u && (first < 0 || side(h).twin < 0)) {
            first = h;
        }
    }
    out_[at(u)] = first;
    degree_[at(v)] = 0;
}

}  // namespace leafcutter::geometry
