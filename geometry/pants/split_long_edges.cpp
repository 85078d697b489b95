#include "geometry/pants/split_long_edges.h"

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <utility>

namespace leafcutter::geometry {
namespace {

// Longest word an edge may keep.
constexpr std::size_t kLongestWord = 2;
// Split points stay this part of the mesh edge away from its ends.
constexpr double kLeastFraction = 0.1;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

std::uint64_t key_of(int a, int b) {
    return (static_cast<std::uint64_t>(std::min(a, b)) << 32U) |
           static_cast<std::uint64_t>(std::max(a, b));
}

// Words by vertex pair, stored from the smaller vertex to the larger.
class WordTable {
public:
    void put(int a, int b, Word word) {
        words_[key_of(a, b)] = a < b ? std::move(word) : reversed(word);
    }
    Word get(int a, int b) const {
        const Word& word = words_.at(key_of(a, b));
        return a < b ? word : reversed(word);
    }

private:
    std::unordered_map<std::uint64_t, Word> words_;
};

// A point inside the path of a word: on its dart `index`, neither the first nor the last.
struct SplitPoint {
    std::size_t index = 0;
    int graph_edge = 0;
    double t = 0.0;
    double fraction = 0.0;    // Of the mesh edge's length.
    double from_start = 0.0;  // Tree distance from the path's start.
};

// In the middle of an inner dart: both halves are then shorter words, so that splitting ends. The
// middle of the path may lie on its first dart and leave the other half as long as the whole.
SplitPoint middle_of(const GraphMap& map, int a, int b, const Word& word) {
    SplitPoint point;
    point.index = word.size() / 2;
    const Dart dart = word[point.index];
    point.graph_edge = edge_of(dart);
    point.t = 0.5 * map.weight(point.graph_edge);
    point.from_start = map.remaining(a, word.front()) + point.t;
    for (std::size_t k = 1; k < point.index; ++k) {
        point.from_start += map.weight(edge_of(word[k]));
    }
    point.fraction = std::clamp(point.from_start / map.distance(a, b, word), kLeastFraction,
                                1.0 - kLeastFraction);
    return point;
}

Word tail_from(const Word& word, std::size_t index) {
    if (word.empty() && index == 0) {
        return {};
    }
    if (index >= word.size()) {
        throw Error(ErrorKind::SelfCheck, "broken-tree",
                    "harmonic map: the paths round a triangle don't fit together");
    }
    Word tail(word.begin() + static_cast<std::ptrdiff_t>(index), word.end());
    return tail.size() == 1 ? Word{} : tail;
}

// The path from the split point of a -> b to the triangle's third vertex c, by the tripod of the
// three.
Word word_to_apex(const GraphMap& map,
                  const WordTable& words,
                  const std::array<int, 3>& abc,
                  const SplitPoint& point) {
    const auto [a, b, c] = abc;
    const Word ab = words.get(a, b);
    const Word ac = words.get(a, c);
    const Word bc = words.get(b, c);
    const double shared =
        0.5 * (map.distance(a, b, ab) + map.distance(a, c, ac) - map.distance(b, c, bc));
    if (point.from_start <= shared) {
        return tail_from(ac, point.index);
    }
    return tail_from(bc, ab.size() - 1 - point.index);
}

// The longest first: splitting one beside a longer one makes new ones for ever.
std::vector<int> independent_long_edges(const VertexRings& rings,
                                        const HalfEdges& half_edges,
                                        const GraphMap& map) {
    std::vector<int> wanted;
    for (std::size_t e = 0; e < rings.edges.size(); ++e) {
        if (map.words[e].size() > kLongestWord) {
            wanted.push_back(static_cast<int>(e));
        }
    }
    std::stable_sort(wanted.begin(), wanted.end(), [&](int a, int b) {
        return map.words[at(a)].size() > map.words[at(b)].size();
    });
    std::vector<char> taken(at(half_edges.size() / 3), 0);
    std::vector<int> chosen;
    for (const int e : wanted) {
        const int h = rings.edges[at(e)].half_edge;
        const int twin = half_edges.twin_of(h);
        if (taken[at(h / 3)] != 0 || (twin >= 0 && taken[at(twin / 3)] != 0)) {
            continue;
        }
        taken[at(h / 3)] = 1;
        if (twin >= 0) {
            taken[at(twin / 3)] = 1;
        }
        chosen.push_back(e);
    }
    return chosen;
}

}  // namespace

int split_long_edges(TriangleMesh& mesh, VertexRings& rings, GraphMap& map) {
    const HalfEdges half_edges =
        build_half_edges(mesh.triangles, static_cast<int>(mesh.positions.size()));
    const std::vector<int> chosen = independent_long_edges(rings, half_edges, map);
    if (chosen.empty()) {
        return 0;
    }
    WordTable words;
    for (std::size_t e = 0; e < rings.edges.size(); ++e) {
        words.put(rings.edges[e].from, rings.edges[e].to, map.words[e]);
    }
    for (const int e : chosen) {
        const MeshEdge edge = rings.edges[at(e)];
        const Word word = map.words[at(e)];
        const SplitPoint point = middle_of(map, edge.from, edge.to, word);
        const int x = static_cast<int>(mesh.positions.size());
        mesh.positions.push_back((1.0 - point.fraction) * mesh.positions[at(edge.from)] +
                                 point.fraction * mesh.positions[at(edge.to)]);
        const int twin = half_edges.twin_of(edge.half_edge);
        for (const int h : {edge.half_edge, twin}) {
            if (h < 0) {
                continue;
            }
            const int a = half_edges.from_of(h);
            const int b = half_edges.to_of(h);
            const int c = half_edges.from_of(HalfEdges::previous(h));
            words.put(x, c, word_to_apex(map, words, {edge.from, edge.to, c}, point));
            mesh.triangles[at(h / 3)] = {a, x, c};
            mesh.triangles.push_back({x, b, c});
        }
        Word head(word.begin(), word.begin() + static_cast<std::ptrdiff_t>(point.index) + 1);
        words.put(edge.from, x, head.size() == 1 ? Word{} : head);
        words.put(x, edge.to, tail_from(word, point.index));
        map.graph_edge.push_back(point.graph_edge);
        map.t.push_back(point.t);
        map.fixed.push_back(0);
    }
    const int count = static_cast<int>(mesh.positions.size());
    rings = build_vertex_rings(build_half_edges(mesh.triangles, count), count);
    map.words.clear();
    for (const MeshEdge& edge : rings.edges) {
        map.words.push_back(words.get(edge.from, edge.to));
    }
    return static_cast<int>(chosen.size());
}

}  // namespace leafcutter::geometry
