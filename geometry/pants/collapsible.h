// A triangle mesh whose half-edges v -> u can be collapsed: v and the two triangles at the edge go,
// v's other neighbours are joined to u. Internal to pants.
//
// One vertex at a time is looked at: look() gathers its ring, the rest speaks of that.

#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "geometry/half_edges.h"

namespace leafcutter::geometry {

struct CollapsibleEntry {
    int neighbour = 0;
    int half_edge = 0;  // Out of the middle, in the triangle before the next neighbour; -1: a gap.
};

class CollapsibleMesh {
public:
    CollapsibleMesh(std::span<const std::array<int, 3>> triangles, int vertex_count);

    // Half-edges numbered as in HalfEdges; those of triangles that are gone start at -1.
    int half_edges() const { return static_cast<int>(sides_.size()); }
    int from_of(int h) const { return side(h).from; }
    int to_of(int h) const { return side(HalfEdges::next(h)).from; }

    int degree(int v) const { return degree_[static_cast<std::size_t>(v)]; }  // 0: gone.
    bool on_boundary(int v) const { return side(out_[static_cast<std::size_t>(v)]).twin < 0; }

    void look(int v);
    // Of the vertex looked at, counter-clockwise; a boundary vertex's from gap to gap.
    const std::vector<CollapsibleEntry>& ring() const { return ring_; }
    bool is_closed() const { return closed_; }

    // The link condition: the vertex and the neighbour at `slot` share the two corners that face
    // their edge (one on the boundary), and no other neighbour. Then the collapse keeps the
    // topology.
    bool may_collapse(std::size_t slot) const;

    void collapse(int v, std::size_t slot);

private:
    struct Side {
        int from = -1;
        int twin = -1;  // -1: boundary.
    };

    Side& side(int h) { return sides_[static_cast<std::size_t>(h)]; }
    const Side& side(int h) const { return sides_[static_cast<std::size_t>(h)]; }
    bool keeps_ring(int corner) const;
    int close_triangle(int h, int kept);

    std::vector<Side> sides_;
    std::vector<int> out_;     // A half-edge out of each vertex: a boundary one's own first.
    std::vector<int> degree_;  // Neighbours.
    std::vector<int> mark_;    // Number of the look at which it was a neighbour.
    std::vector<CollapsibleEntry> ring_;
    bool closed_ = true;
    int looks_ = 0;
};

}  // namespace leafcutter::geometry
