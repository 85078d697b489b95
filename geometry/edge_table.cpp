#include "geometry/edge_table.h"

#include <algorithm>

namespace leafcutter::geometry {

std::vector<Side> sorted_sides(std::span<const Triangle> triangles) {
    std::vector<Side> sides;
    sides.reserve(3 * triangles.size());
    for (std::uint32_t side = 0; side < 3 * triangles.size(); ++side) {
        sides.push_back({edge_key(side_start(triangles, side), side_end(triangles, side)), side});
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return a.edge != b.edge ? a.edge < b.edge : a.index < b.index;
    });
    return sides;
}

std::size_t count_non_manifold_edges(std::span<const Triangle> triangles) {
    std::size_t count = 0;
    for_each_edge(sorted_sides(triangles),
                  [&](std::span<const Side> sides) { count += sides.size() > 2 ? 1 : 0; });
    return count;
}

}  // namespace leafcutter::geometry
