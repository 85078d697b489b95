// A simplicial triangle mesh whose edges can be flipped and keep their numbers. Internal to pants.

#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "geometry/half_edges.h"
#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

class FlippableMesh {
public:
    explicit FlippableMesh(const VertexRings& rings) {
        sides_.resize(rings.edge_of_half_edge.size());
        half_edge_.assign(rings.edges.size(), -1);
        for (std::size_t h = 0; h < sides_.size(); ++h) {
            const int edge = rings.edge_of_half_edge[h];
            const MeshEdge& ends = rings.edges[static_cast<std::size_t>(edge)];
            const int index = static_cast<int>(h);
            int& first = half_edge_[static_cast<std::size_t>(edge)];
            sides_[h] = {ends.half_edge == index ? ends.from : ends.to, first, edge};
            if (first < 0) {
                first = index;
            } else {
                side(first).twin = index;
            }
        }
    }

    int half_edges() const { return static_cast<int>(sides_.size()); }
    int edges() const { return static_cast<int>(half_edge_.size()); }
    int half_edge_of(int edge) const { return half_edge_[static_cast<std::size_t>(edge)]; }
    int edge_of(int h) const { return side(h).edge; }
    int twin_of(int h) const { return side(h).twin; }
    int from_of(int h) const { return side(h).from; }
    int to_of(int h) const { return side(HalfEdges::next(h)).from; }
    // The corner that faces `h`.
    int facing(int h) const { return side(HalfEdges::previous(h)).from; }

    // Flips the edge a-b of triangles abc and bad to c-d. Sides: h a->b, then b->c, c->a; t b->a,
    // a->d, d->b; afterwards h c->d, d->b, b->c; t d->c, c->a, a->d.
    void flip(int h) {
        const int t = twin_of(h);
        const int h1 = HalfEdges::next(h);
        const int h2 = HalfEdges::previous(h);
        const int t1 = HalfEdges::next(t);
        const int t2 = HalfEdges::previous(t);
        const std::array<Side, 4> moved{side(t2), side(h1), side(h2), side(t1)};
        const std::array<int, 4> places{h1, h2, t1, t2};
        for (std::size_t k = 0; k < 4; ++k) {
            side(places[k]) = moved[k];
            if (moved[k].twin >= 0) {
                side(moved[k].twin).twin = places[k];
            }
            half_edge_[static_cast<std::size_t>(moved[k].edge)] = places[k];
        }
        side(h).from = moved[2].from;  // c
        side(t).from = moved[0].from;  // d
    }

    HalfEdges to_half_edges() const {
        HalfEdges out;
        out.from.reserve(sides_.size());
        out.twin.reserve(sides_.size());
        for (const Side& one : sides_) {
            out.from.push_back(one.from);
            out.twin.push_back(one.twin);
        }
        return out;
    }

    std::vector<int> edge_numbers() const {
        std::vector<int> out;
        out.reserve(sides_.size());
        for (const Side& one : sides_) {
            out.push_back(one.edge);
        }
        return out;
    }

private:
    struct Side {
        int from = -1;
        int twin = -1;  // -1: boundary.
        int edge = -1;
    };

    Side& side(int h) { return sides_[static_cast<std::size_t>(h)]; }
    const Side& side(int h) const { return sides_[static_cast<std::size_t>(h)]; }

    std::vector<Side> sides_;     // Per half-edge, numbered as in HalfEdges.
    std::vector<int> half_edge_;  // Per edge: one of its half-edges.
};

}  // namespace leafcutter::geometry
