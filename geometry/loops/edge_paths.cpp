#include "geometry/loops/edge_paths.h"

#include <cstddef>

#include "geometry/error.h"

namespace leafcutter::geometry {

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

}  // namespace leafcutter::geometry
