// The sides of a triangle list, grouped by the edge they lie on. Internal to geometry.

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace leafcutter::geometry {

using Triangle = std::array<std::uint32_t, 3>;

// Side 3 f + k of triangle f runs from its corner k to its corner k + 1.
struct Side {
    std::uint64_t edge = 0;  // Smaller vertex in the upper half, larger one in the lower.
    std::uint32_t index = 0;

    std::uint32_t low() const { return static_cast<std::uint32_t>(edge >> 32U); }
    std::uint32_t high() const { return static_cast<std::uint32_t>(edge); }
    std::uint32_t face() const { return index / 3; }
};

inline std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
    return a < b ? (std::uint64_t{a} << 32U) | b : (std::uint64_t{b} << 32U) | a;
}

inline std::uint32_t side_start(std::span<const Triangle> triangles, std::uint32_t side) {
    return triangles[side / 3][side % 3];
}

inline std::uint32_t side_end(std::span<const Triangle> triangles, std::uint32_t side) {
    return triangles[side / 3][(side % 3 + 1) % 3];
}

// All sides, sorted by edge, then by index.
std::vector<Side> sorted_sides(std::span<const Triangle> triangles);

// Calls `visit` with the sides of each edge, edges in rising order.
template <typename Visit>
void for_each_edge(std::span<const Side> sides, Visit visit) {
    for (std::size_t begin = 0; begin < sides.size();) {
        std::size_t end = begin + 1;
        while (end < sides.size() && sides[end].edge == sides[begin].edge) {
            ++end;
        }
        visit(sides.subspan(begin, end - begin));
        begin = end;
    }
}

// Number of edges with more than two sides.
std::size_t count_non_manifold_edges(std::span<const Triangle> triangles);

}  // namespace leafcutter::geometry
