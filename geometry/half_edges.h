// Half-edges of an indexed triangle mesh, as flat arrays for the numerical code.
//
// Half-edge 3t + k runs from corner k of triangle t to its corner k + 1.

#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace leafcutter::geometry {

struct HalfEdges {
    std::vector<int> from;  // Start vertex.
    std::vector<int> twin;  // The same edge in the neighbour triangle, or -1 on the boundary.

    static int next(int half_edge) { return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1; }
    static int previous(int half_edge) {
        return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1;
    }

    int size() const { return static_cast<int>(from.size()); }
    int from_of(int half_edge) const { return from[static_cast<std::size_t>(half_edge)]; }
    int to_of(int half_edge) const { return from_of(next(half_edge)); }
    int twin_of(int half_edge) const { return twin[static_cast<std::size_t>(half_edge)]; }

    // True for one half-edge of each edge: the boundary's only one, or the lower index.
    bool is_first(int half_edge) const {
        return twin_of(half_edge) < 0 || half_edge < twin_of(half_edge);
    }
};

// Throws Error(BadMesh, "non-manifold-edges") if an edge has more than two triangles or two that
// disagree in orientation.
HalfEdges build_half_edges(std::span<const std::array<int, 3>> triangles, int vertex_count);

// The triangles that the half-edges go round.
std::vector<std::array<int, 3>> triangles_of(const HalfEdges& edges);

}  // namespace leafcutter::geometry
