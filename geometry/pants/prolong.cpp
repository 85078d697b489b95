// A map seen from a finer level: composed with the collapse, which is simplicial, so that every
// fine edge runs to a coarse edge or to a single vertex.

#include <fmt/format.h>

#include "geometry/pants/level.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

const RingSlot& slot_between(const VertexRings& rings, int from, int to) {
    for (int k = rings.begin[at(from)]; k < rings.begin[at(from) + 1]; ++k) {
        if (rings.slots[at(k)].neighbour == to) {
            return rings.slots[at(k)];
        }
    }
    throw Error(ErrorKind::SelfCheck, "broken-tree",
                fmt::format("levels of detail: no coarse edge joins vertices {} and {}", from, to));
}

int degree(const VertexRings& rings, int v) {
    return rings.begin[at(v) + 1] - rings.begin[at(v)];
}

// The word from `from` to `to`, looked up in the smaller of the two rings.
Word word_between(const GraphMap& map, const VertexRings& rings, int from, int to) {
    const bool from_first = degree(rings, from) <= degree(rings, to);
    const RingSlot& slot =
        from_first ? slot_between(rings, from, to) : slot_between(rings, to, from);
    const Word& word = map.words[at(slot.edge)];
    return slot.forward == from_first ? word : reversed(word);
}

}  // namespace

GraphMap prolong(const GraphMap& coarse,
                 const VertexRings& coarse_rings,
                 std::span<const int> representative,
                 const VertexRings& fine_rings) {
    GraphMap fine;
    fine.graph = coarse.graph;
    fine.graph_edge.reserve(representative.size());
    fine.t.reserve(representative.size());
    fine.fixed.reserve(representative.size());
    for (std::size_t v = 0; v < representative.size(); ++v) {
        const std::size_t kept = at(representative[v]);
        fine.graph_edge.push_back(coarse.graph_edge[kept]);
        fine.t.push_back(coarse.t[kept]);
        // Vertices of the inside collapsed to the boundary too, but aren't held there.
        const RingSlot& last = fine_rings.slots[at(fine_rings.begin[v + 1]) - 1];
        fine.fixed.push_back(last.link < 0 ? coarse.fixed[kept] : char{0});
    }
    fine.words.resize(fine_rings.edges.size());
    for (std::size_t e = 0; e < fine_rings.edges.size(); ++e) {
        const int from = representative[at(fine_rings.edges[e].from)];
        const int to = representative[at(fine_rings.edges[e].to)];
        if (from != to) {
            fine.words[e] = word_between(coarse, coarse_rings, from, to);
        }
    }
    return fine;
}

}  // namespace leafcutter::geometry
