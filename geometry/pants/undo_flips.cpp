// The words of a map on a surface whose flips are taken back.
//
// Words say where three corners of a triangle lie in the tree, exactly: of three paths between
// three edges of a tree, two share a start that their numbers of edges tell. So the two triangles
// at an edge a-b place c and d in the tree relative to a and b, but for one doubt: where both leave
// the path from a to b at the same node, along edges of the same name, these may be two edges of
// the tree or one. They are two, c and d lying on different sides of the critical graph's arc that
// crosses a-b, unless the other triangles round a or b say that c and d share more.

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "geometry/pants/flippable.h"
#include "geometry/pants/level.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

[[noreturn]] void refuse() {
    throw Error(ErrorKind::SelfCheck, "broken-tree",
                "undoing flips: the paths round a triangle don't fit together");
}

// Edges of the tree that a path touches.
int edges_of(const Word& word) {
    return word.empty() ? 1 : static_cast<int>(word.size());
}

// What is left of a word without its first `from` darts.
Word tail(const Word& word, int from) {
    if (static_cast<int>(word.size()) < from + 2) {
        return {};
    }
    return {word.begin() + from, word.end()};
}

// With how many edges the paths from one corner to two others start alike, its own included.
// `opposite` is the path between the others, either way.
int shared_edges(const Word& one, const Word& other, const Word& opposite) {
    const int ones = edges_of(one);
    const int others = edges_of(other);
    const int twice = ones + others - edges_of(opposite);
    const int shared = (twice + 1) / 2;
    if (twice < 1 || shared > std::min(ones, others)) {
        refuse();
    }
    const bool at_node = twice % 2 == 0;
    if (!at_node && shared != 1 && shared != ones && shared != others) {
        refuse();
    }
    if (at_node && shared == std::min(ones, others)) {
        refuse();
    }
    const bool leave_alike = at_node || shared > 1;
    if (leave_alike && !std::equal(one.begin(), one.begin() + shared, other.begin())) {
        refuse();
    }
    const bool leave_apart = !at_node && shared == 1 && ones > 1 && others > 1;
    if (leave_apart && one.front() == other.front()) {
        refuse();
    }
    return shared;
}

// The path between the ends of two paths that start alike in `shared` edges.
Word join(const Word& to_c, const Word& to_d, int shared) {
    if (shared == edges_of(to_c)) {  // c lies on the path to d.
        return tail(to_d, shared - 1);
    }
    if (shared == edges_of(to_d)) {
        return reversed(tail(to_c, shared - 1));
    }
    const bool opposite = to_c.front() != to_d.front();
    const int own = opposite ? 1 : 0;  // The own edge is on the path once.
    Word word(to_c.begin() + shared - own, to_c.end());
    word = reversed(word);
    word.insert(word.end(), to_d.begin() + shared, to_d.end());
    return word;
}

// Whether the paths may go on together after `shared` edges.
bool may_share_more(const Word& to_c, const Word& to_d, int shared) {
    return shared < edges_of(to_c) && shared < edges_of(to_d) && to_c.front() == to_d.front() &&
           to_c[at(shared)] == to_d[at(shared)];
}

class Undoing {
public:
    Undoing(GraphMap& map, const VertexRings& flipped)
        : map_(map), mesh_(flipped), start_(flipped.edges.size()) {
        for (std::size_t e = 0; e < start_.size(); ++e) {
            start_[e] = flipped.edges[e].from;
        }
    }

    void undo(int edge) {
        const int h = mesh_.half_edge_of(edge);
        const int c = mesh_.facing(h);
        Word word = other_diagonal(h);
        mesh_.flip(h);
        map_.words[at(edge)] = std::move(word);
        start_[at(edge)] = c;
    }

    // Words as edges run in `rings`.
    void turn_to(const VertexRings& rings) {
        for (std::size_t e = 0; e < start_.size(); ++e) {
            const int h = mesh_.half_edge_of(static_cast<int>(e));
            const std::pair ends(mesh_.from_of(h), mesh_.to_of(h));
            const MeshEdge& edge = rings.edges[e];
            if (ends != std::pair(edge.from, edge.to) && ends != std::pair(edge.to, edge.from)) {
                throw Error(ErrorKind::SelfCheck, "broken-tree",
                            "undoing flips: the surface is not the one that was flipped");
            }
            if (start_[e] != edge.from) {
                map_.words[e] = reversed(map_.words[e]);
            }
        }
    }

private:
    const Word& stored(int h) const { return map_.words[at(mesh_.edge_of(h))]; }

    // From the start of half-edge `h` to its end.
    Word along(int h) const {
        return start_[at(mesh_.edge_of(h))] == mesh_.from_of(h) ? stored(h) : reversed(stored(h));
    }

    // From c to d, where h runs from a to b in the triangle abc and its twin in bad.
    Word other_diagonal(int h) const {
        const int t = mesh_.twin_of(h);
        const int h1 = HalfEdges::next(h);
        const int h2 = HalfEdges::previous(h);
        const int t1 = HalfEdges::next(t);
        const int t2 = HalfEdges::previous(t);
        if (stored(h1).empty() && stored(h2).empty() && stored(t1).empty() && stored(t2).empty()) {
            return {};
        }
        const std::optional<Word> at_a = seen_from(h);
        const std::optional<Word> at_b = at_a ? std::nullopt : seen_from(t);
        if (at_a || at_b) {
            return at_a ? *at_a : reversed(*at_b);
        }
        const Word to_c = reversed(along(h2));
        const Word to_d = along(t1);
        return join(to_c, to_d, shared_edges(along(h), to_c, stored(h1)));
    }

    // The path from c to d as the corner a knows it, the start of `h`; none if in doubt.
    std::optional<Word> seen_from(int h) const {
        const int t = mesh_.twin_of(h);
        const Word to_b = along(h);
        const Word to_c = reversed(along(HalfEdges::previous(h)));
        const Word to_d = along(HalfEdges::next(t));
        const int b_and_c = shared_edges(to_b, to_c, stored(HalfEdges::next(h)));
        const int b_and_d = shared_edges(to_b, to_d, stored(HalfEdges::previous(t)));
        const int shared = std::min(b_and_c, b_and_d);
        if (b_and_c != b_and_d || !may_share_more(to_c, to_d, shared)) {
            return join(to_c, to_d, shared);
        }
        const int round = shared_round(h);
        if (round > shared) {
            return join(to_c, to_d, round);
        }
        return std::nullopt;
    }

    // Least number of edges that paths from a to neighbouring corners share, all the way round a
    // from c to d without b; 0 at the boundary.
    int shared_round(int h) const {
        const int last = HalfEdges::next(mesh_.twin_of(h));  // a -> d
        int least = std::numeric_limits<int>::max();
        int side = mesh_.twin_of(HalfEdges::previous(h));  // a -> c
        while (side != last) {
            if (side < 0) {
                return 0;
            }
            const Word right = along(side);
            const Word left = reversed(along(HalfEdges::previous(side)));
            least = std::min(least, shared_edges(right, left, stored(HalfEdges::next(side))));
            side = mesh_.twin_of(HalfEdges::previous(side));
        }
        return least;
    }

    GraphMap& map_;
    FlippableMesh mesh_;
    std::vector<int> start_;  // Per edge: the vertex its word starts at.
};

}  // namespace

void undo_flips(GraphMap& map,
                const FlippedSurface& flipped,
                const LinedSurface& /*surface*/,
                const VertexRings& rings) {
    Undoing undoing(map, flipped.rings);
    for (std::size_t k = flipped.flips.size(); k > 0; --k) {
        undoing.undo(flipped.flips[k - 1]);
    }
    undoing.turn_to(rings);
}

}  // namespace leafcutter::geometry
