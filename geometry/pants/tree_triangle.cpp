#include "geometry/pants/tree_triangle.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace leafcutter::geometry {
namespace {

// The way from the end of `ab` to that of `ac` if they part after `shared` darts.
Word joined(const Word& ab, const Word& ac, std::size_t shared) {
    const auto from = [](const Word& word, std::size_t k) {
        return Word(word.begin() + static_cast<std::ptrdiff_t>(k), word.end());
    };
    if (shared > 0 && (shared == ab.size() || shared == ac.size())) {
        // One of them ends on the last shared edge.
        const Word rest =
            shared == ab.size() ? from(ac, shared - 1) : reversed(from(ab, shared - 1));
        return rest.size() < 2 ? Word{} : rest;
    }
    Word way = reversed(from(ab, shared));
    if (shared == 0 && !way.empty() && !ac.empty()) {
        way.pop_back();  // The first vertex's own edge, which both ways have.
    }
    const Word rest = from(ac, shared);
    way.insert(way.end(), rest.begin(), rest.end());
    return way;
}

}  // namespace

int shared_darts(const Word& ab, const Word& bc, const Word& ac) {
    const auto same = std::mismatch(ab.begin(), ab.end(), ac.begin(), ac.end()).first - ab.begin();
    for (int shared = same > 0 ? 1 : 0; shared <= same; ++shared) {
        if (joined(ab, ac, static_cast<std::size_t>(shared)) == bc) {
            return shared;
        }
    }
    return -1;
}

bool words_fit(const Word& ab, const Word& bc, const Word& ac) {
    if (ab.empty() || ac.empty()) {
        return bc == (ab.empty() ? ac : reversed(ab));
    }
    return shared_darts(ab, bc, ac) >= 0;
}

int find_misfit(const GraphMap& map, const VertexRings& rings) {
    for (std::size_t t = 0; 3 * t < rings.edge_of_half_edge.size(); ++t) {
        std::array<Word, 3> side;

        for (std::size_t k = 0; k < 3; ++k) {  // Sides ab, bc, ca as the triangle runs.
            const auto e = static_cast<std::size_t>(rings.edge_of_half_edge[3 * t + k]);
            const auto next =
                static_cast<std::size_t>(rings.edge_of_half_edge[3 * t + (k + 1) % 3]);
            const MeshEdge& edge = rings.edges[e];
            const MeshEdge& after = rings.edges[next];
            const bool forward = edge.to == after.from || edge.to == after.to;

            side[k] = forward ? map.words[e] : reversed(map.words[e]);
        }
        if (!words_fit(side[0], side[1], reversed(side[2]))) {
            return static_cast<int>(t);
        }
    }
    return -1;
}

}  // namespace leafcutter::geometry
