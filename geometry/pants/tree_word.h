// Paths in the dual tree of a pants decomposition, and the graph-valued map they belong to.
//
// The map's target is not the metric graph but its unfolding, the dual tree of the decomposition:
// a path that runs into an edge of the graph and back out again may be essential there. A path is
// stored as the word of darts it traverses, own edges of both ends included, and never reduced.
// With the graph's own distance the minimum has broken cylinders.
//
// Source: M. Wolf, "On realizing measured foliations via quadratic differentials of harmonic maps
// to R-trees", 1996; the paper's section 3.3 for the energy.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "geometry/foliation.h"

namespace leafcutter::geometry {

// Dart 2e runs along graph edge e from its start to its end, 2e + 1 back.
using Dart = int;
inline constexpr Dart reversed(Dart dart) {
    return dart ^ 1;
}
inline constexpr int edge_of(Dart dart) {
    return dart / 2;
}
inline constexpr bool runs_forward(Dart dart) {
    return dart % 2 == 0;
}

// Darts from the own edge of one point to the own edge of another, both inclusive; empty if the
// path stays inside one edge. Never of length 1.
using Word = std::vector<Dart>;

inline Word reversed(const Word& word) {
    Word back(word.rbegin(), word.rend());
    std::transform(back.begin(), back.end(), back.begin(), [](Dart d) { return reversed(d); });
    return back;
}

// Where every vertex and every mesh edge of a surface lies in the tree.
struct GraphMap {
    MetricGraph graph;
    std::vector<int> graph_edge;  // Per vertex.
    std::vector<double> t;        // Per vertex, in [0, weight of its edge].
    std::vector<char> fixed;      // Per vertex: held at a boundary's end node.
    std::vector<Word> words;      // Per mesh edge, from its `from` to its `to`.

    double weight(int edge) const { return graph.edges[static_cast<std::size_t>(edge)].weight; }
    int start_node(Dart dart) const {
        const MetricGraph::Edge& edge = graph.edges[static_cast<std::size_t>(edge_of(dart))];
        return runs_forward(dart) ? edge.from : edge.to;
    }
    int end_node(Dart dart) const { return start_node(reversed(dart)); }

    // From vertex `v` to the end of `dart`, which lies on its own edge.
    double remaining(int v, Dart dart) const {
        const auto i = static_cast<std::size_t>(v);
        return runs_forward(dart) ? weight(graph_edge[i]) - t[i] : t[i];
    }

    // Length of all darts but the first and the last.
    double inner_length(const Word& word) const {
        double length = 0.0;
        for (std::size_t k = 1; k + 1 < word.size(); ++k) {
            length += weight(edge_of(word[k]));
        }
        return length;
    }

    double distance(int a, int b, const Word& word) const {
        if (word.empty()) {
            return std::abs(t[static_cast<std::size_t>(a)] - t[static_cast<std::size_t>(b)]);
        }
        return remaining(a, word.front()) + inner_length(word) +
               remaining(b, reversed(word.back()));
    }
};

}  // namespace leafcutter::geometry
