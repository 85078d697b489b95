#include "geometry/loops/edge_paths.h"

#include <cstddef>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

}  // namespace

int find_edge(const VertexRings& rings, int a, int b) {
    const auto v = static_cast<std::size_t>(a);
    for (int k = rings.begin[v]; k < rings.begin[v + 1]; ++k) {
        const RingSlot& slot = rings.slots[static_cast<std::size_t>(k)];
        if (slot.neighbour == b) {
            return slot.edge;
        }
    }
    throw Error(ErrorKind::SelfCheck, "no-such-edge", "loops: two vertices are not joined");
}

std::vector<double> path_lengths(const VertexRings& rings,
                                 std::span<const Eigen::Vector3d> positions,
                                 std::span<const int> sources) {
    std::vector<double> length(positions.size(), std::numeric_limits<double>::infinity());
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (const int v : sources) {
        length[at(v)] = 0.0;
        queue.emplace(0.0, v);
    }
    while (!queue.empty()) {
        const auto [d, v] = queue.top();
        queue.pop();
        if (d > length[at(v)]) {
            continue;
        }
        for (int k = rings.begin[at(v)]; k < rings.begin[at(v) + 1]; ++k) {
            const int w = rings.slots[at(k)].neighbour;
            const double through = d + (positions[at(v)] - positions[at(w)]).norm();
            if (through < length[at(w)]) {
                length[at(w)] = through;
                queue.emplace(through, w);
            }
        }
    }
    return length;
}

}  // namespace leafcutter::geometry
