#include "geometry/quads/quad_edges.h"

#include <algorithm>
#include <cstddef>
#include <tuple>

namespace leafcutter::geometry {

namespace {

struct HalfEdge {
    int low = 0;
    int high = 0;
    bool forward = false;  // From low to high.
    QuadSide at;

    bool same_edge(const HalfEdge& other) const { return low == other.low && high == other.high; }
};

std::vector<HalfEdge> sorted_half_edges(std::span<const std::array<int, 4>> quads) {
    std::vector<HalfEdge> all;
    all.reserve(4 * quads.size());
    for (int quad = 0; quad < static_cast<int>(quads.size()); ++quad) {
        const auto& corners = quads[static_cast<std::size_t>(quad)];
        for (int side = 0; side < 4; ++side) {
            const int from = corners[static_cast<std::size_t>(side)];
            const int to = corners[static_cast<std::size_t>((side + 1) % 4)];
            all.push_back({.low = std::min(from, to),
                           .high = std::max(from, to),
                           .forward = from < to,
                           .at = {.quad = quad, .side = side}});
        }
    }
    std::sort(all.begin(), all.end(), [](const HalfEdge& a, const HalfEdge& b) {
        return std::tie(a.low, a.high, a.at.quad, a.at.side) <
               std::tie(b.low, b.high, b.at.quad, b.at.side);
    });
    return all;
}

}  // namespace

QuadNeighbours find_neighbours(std::span<const std::array<int, 4>> quads) {
    const std::vector<HalfEdge> all = sorted_half_edges(quads);
    QuadNeighbours found;
    found.across.resize(quads.size());
    const auto slot = [&found](const QuadSide& at) -> QuadSide& {
        return found.across[static_cast<std::size_t>(at.quad)][static_cast<std::size_t>(at.side)];
    };
    for (std::size_t first = 0; first < all.size();) {
        std::size_t end = first + 1;
        while (end < all.size() && all[end].same_edge(all[first])) {
            ++end;
        }
        ++found.edges;
        const bool loop = all[first].low == all[first].high;
        if (end - first == 1 && !loop) {
            ++found.boundary_edges;
        } else if (end - first == 2 && !loop && all[first].forward != all[first + 1].forward) {
            slot(all[first].at) = all[first + 1].at;
            slot(all[first + 1].at) = all[first].at;
        } else {
            ++found.faults;
        }
        first = end;
    }
    return found;
}

}  // namespace leafcutter::geometry
