#include "geometry/pants/initial_map.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "geometry/disjoint_sets.h"
#include "geometry/loops/edge_paths.h"
#include "geometry/pants/draw_onto.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// A point of the metric graph; `node` >= 0 says it is that node, seen from the start of `dart`.
struct Spot {
    int edge = -1;
    double t = 0.0;
    int node = -1;  // Graph node, -1 inside an edge.
    Dart dart = -1;
};

class PantsGraph {
public:
    explicit PantsGraph(const ReebGraph& reeb) : reeb_(reeb), arcs_at_(reeb.node_vertex.size()) {
        prune();
        name_graph_nodes();
        join_chains();
    }

    const MetricGraph& graph() const { return graph_; }
    bool is_core(int arc) const { return pruned_[at(arc)] == 0; }
    int graph_node(int node) const { return graph_node_[at(node)]; }

    // The dart that an arc runs along, upwards.
    Dart dart_up(int arc) const { return 2 * chain_of_[at(arc)] + (with_chain_[at(arc)] ? 0 : 1); }

    Spot spot_of_node(int node) const {
        while (hangs_at_[at(node)] >= 0) {
            node = hangs_at_[at(node)];
        }
        if (graph_node_[at(node)] >= 0) {
            const Dart dart = first_dart_[at(graph_node_[at(node)])];
            const double t = runs_forward(dart) ? 0.0 : graph_.edges[at(edge_of(dart))].weight;
            return {edge_of(dart), t, graph_node_[at(node)], dart};
        }
        for (const int arc : arcs_at_[at(node)]) {
            if (is_core(arc)) {
                const bool low = reeb_.arcs[at(arc)].low == node;
                return spot_on_arc(arc, low ? 0.0 : arc_length(arc));
            }
        }
        throw Error(ErrorKind::SelfCheck, "pants-graph", "pants: a Reeb node hangs nowhere");
    }

    Spot spot_of_vertex(int v) const {
        const int node = reeb_.node_of_vertex[at(v)];
        if (node >= 0) {
            const Spot spot = spot_of_node(node);
            const int owner = reeb_.mesh.owner[at(v)];
            return spot.node >= 0 && owner >= 0 && owner != v ? seen_towards(owner, v, spot) : spot;
        }
        const int arc = reeb_.arc_of_vertex[at(v)];
        if (!is_core(arc)) {
            return spot_of_node(reeb_.arcs[at(arc)].low);
        }
        return spot_on_arc(arc, reeb_.mesh.value[at(v)] - reeb_.arcs[at(arc)].low_value);
    }

private:
    // The spot of a vertex at a graph node, on the leg in which its neighbour `owner` lies.
    Spot seen_towards(int owner, int v, Spot spot) const {
        const VertexRings& rings = reeb_.mesh.rings;
        for (int k = rings.begin[at(v)]; k < rings.begin[at(v) + 1]; ++k) {
            const RingSlot& slot = rings.slots[at(k)];
            if (slot.neighbour == owner) {
                const std::vector<int>& arcs = reeb_.arcs_of_edge[at(slot.edge)];
                const bool up = (reeb_.edge_runs_up[at(slot.edge)] != 0) == slot.forward;
                spot.dart = up ? dart_up(arcs.front()) : reversed(dart_up(arcs.back()));
                spot.edge = edge_of(spot.dart);
                spot.t = runs_forward(spot.dart) ? 0.0 : 1.0;
            }
        }
        return spot;
    }

    double arc_length(int arc) const {
        return std::max(reeb_.arcs[at(arc)].high_value - reeb_.arcs[at(arc)].low_value, 0.0);
    }

    Spot spot_on_arc(int arc, double above_low) const {
        const double along = with_chain_[at(arc)] ? above_low : arc_length(arc) - above_low;
        const double length = chain_length_[at(chain_of_[at(arc)])];
        const double t = length > 0.0 ? (chain_offset_[at(arc)] + along) / length : 0.5;
        return {chain_of_[at(arc)], std::clamp(t, 0.0, 1.0), -1, -1};
    }

    int other_end(int arc, int node) const {
        const ReebArc& a = reeb_.arcs[at(arc)];
        return a.low == node ? a.high : a.low;
    }

    // Takes away trees that hang from the core, leaf by leaf; boundary caps stay.
    void prune() {
        pruned_.assign(reeb_.arcs.size(), 0);
        hangs_at_.assign(arcs_at_.size(), -1);
        degree_.assign(arcs_at_.size(), 0);
        for (std::size_t a = 0; a < reeb_.arcs.size(); ++a) {
            for (const int node : {reeb_.arcs[a].low, reeb_.arcs[a].high}) {
                arcs_at_[at(node)].push_back(static_cast<int>(a));
                ++degree_[at(node)];
            }
        }
        std::vector<char> keep(arcs_at_.size(), 0);
        for (const int node : reeb_.boundary_node) {
            keep[at(node)] = 1;
        }
        std::vector<int> leaves;
        for (std::size_t n = 0; n < degree_.size(); ++n) {
            if (degree_[n] == 1 && keep[n] == 0) {
                leaves.push_back(static_cast<int>(n));
            }
        }
        while (!leaves.empty()) {
            const int leaf = leaves.back();
            leaves.pop_back();
            for (const int arc : arcs_at_[at(leaf)]) {
                if (pruned_[at(arc)] != 0) {
                    continue;
                }
                pruned_[at(arc)] = 1;
                const int rest = other_end(arc, leaf);
                hangs_at_[at(leaf)] = rest;
                --degree_[at(leaf)];
                if (--degree_[at(rest)] == 1 && keep[at(rest)] == 0) {
                    leaves.push_back(rest);
                }
            }
        }
    }

    void name_graph_nodes() {
        graph_node_.assign(arcs_at_.size(), -1);
        for (std::size_t n = 0; n < degree_.size(); ++n) {
            if (degree_[n] == 1 || degree_[n] >= 3) {
                graph_node_[n] = graph_.nodes++;
            }
        }
        first_dart_.assign(at(graph_.nodes), -1);
    }

    void join_chains() {
        chain_of_.assign(reeb_.arcs.size(), -1);
        with_chain_.assign(reeb_.arcs.size(), false);
        chain_offset_.assign(reeb_.arcs.size(), 0.0);
        for (std::size_t n = 0; n < graph_node_.size(); ++n) {
            if (graph_node_[n] < 0) {
                continue;
            }
            for (const int arc : arcs_at_[n]) {
                if (is_core(arc) && chain_of_[at(arc)] < 0) {
                    follow_chain(static_cast<int>(n), arc);
                }
            }
        }
    }

    void follow_chain(int node, int arc) {
        const int chain = static_cast<int>(graph_.edges.size());
        const int from = graph_node_[at(node)];
        double length = 0.0;
        while (true) {
            chain_of_[at(arc)] = chain;
            with_chain_[at(arc)] = reeb_.arcs[at(arc)].low == node;
            chain_offset_[at(arc)] = length;
            length += arc_length(arc);
            node = other_end(arc, node);
            if (graph_node_[at(node)] >= 0) {
                break;
            }
            for (const int next : arcs_at_[at(node)]) {
                if (is_core(next) && chain_of_[at(next)] < 0) {
                    arc = next;
                    break;
                }
            }
        }
        chain_length_.push_back(length);
        graph_.edges.push_back({from, graph_node_[at(node)], 1.0});
        name_first_dart(from, 2 * chain);
        name_first_dart(graph_node_[at(node)], 2 * chain + 1);
    }

    void name_first_dart(int graph_node, Dart dart) {
        if (first_dart_[at(graph_node)] < 0) {
            first_dart_[at(graph_node)] = dart;
        }
    }

    const ReebGraph& reeb_;
    std::vector<std::vector<int>> arcs_at_;  // Per Reeb node.
    std::vector<int> degree_;                // Of the core.
    std::vector<char> pruned_;               // Per arc.
    std::vector<int> hangs_at_;              // Pruned node: the node its tree goes on to.
    std::vector<int> graph_node_;
    std::vector<int> chain_of_;
    std::vector<bool> with_chain_;
    std::vector<double> chain_offset_;
    std::vector<double> chain_length_;
    std::vector<Dart> first_dart_;  // Per graph node: the own dart of vertices placed there.
    MetricGraph graph_;
};

// The word of a mesh edge between two spots, from the arcs it runs through upwards.
Word word_of(const PantsGraph& pants,
             const ReebGraph& reeb,
             const std::vector<int>& arcs,
             const Spot& low,
             const Spot& high) {
    Word word;
    for (const int arc : arcs) {
        if (!pants.is_core(arc)) {
            continue;
        }
        const bool through_node = pants.graph_node(reeb.arcs[at(arc)].low) >= 0;
        if (word.empty() || through_node) {
            word.push_back(pants.dart_up(arc));
        }
    }
    if (word.empty()) {
        return word;
    }
    if (low.node >= 0 && word.front() != low.dart) {
        word.insert(word.begin(), reversed(low.dart));
    }
    if (high.node >= 0 && word.back() != reversed(high.dart)) {
        word.push_back(high.dart);
    }
    return word.size() == 1 ? Word{} : word;
}

// Ring slots of a saddle that see the same leg in several sectors lie on different edges of the
// tree: all get an essential backtrack but one, that with the neighbour `keep` if there is one.
void part_sectors(GraphMap& map, const VertexRings& rings, int v, Dart own, int keep) {
    const auto begin = at(rings.begin[at(v)]);
    const std::size_t count = at(rings.begin[at(v) + 1]) - begin;
    const auto seen = [&](const RingSlot& slot) {
        const Word& word = map.words[at(slot.edge)];
        return slot.forward ? word : reversed(word);
    };
    std::vector<char> is_own(count);
    for (std::size_t k = 0; k < count; ++k) {
        const Word word = seen(rings.slots[begin + k]);
        is_own[k] = word.empty() || word.front() == own ? 1 : 0;
    }
    std::size_t shift = 0;
    while (shift < count && rings.slots[begin + shift].neighbour != keep) {
        ++shift;
    }
    shift = shift == count ? count - 1 : shift;
    for (std::size_t steps = 0; is_own[shift] != 0; ++steps) {
        if (steps == count) {
            return;
        }
        shift = (shift + count - 1) % count;
    }
    int run = 0;
    bool inside = false;
    for (std::size_t i = 1; i < count; ++i) {
        const std::size_t k = (shift + i) % count;
        run += is_own[k] != 0 && !inside ? 1 : 0;
        inside = is_own[k] != 0;
        if (!inside || run < 2) {
            continue;
        }
        const RingSlot& slot = rings.slots[begin + k];
        Word word = seen(slot);
        if (word.empty()) {
            word.push_back(own);
        }
        word.insert(word.begin(), reversed(own));
        map.words[at(slot.edge)] = slot.forward ? word : reversed(word);
    }
}

void fix_boundaries(GraphMap& map,
                    const PantsGraph& pants,
                    const ReebGraph& reeb,
                    std::span<const std::vector<int>> loops) {
    for (std::size_t k = 0; k < loops.size(); ++k) {
        const Spot end = pants.spot_of_node(reeb.boundary_node[k]);
        for (const int v : loops[k]) {
            if (end.node < 0 || map.graph_edge[at(v)] != end.edge) {
                throw Error(ErrorKind::SelfCheck, "pants-graph",
                            "pants: boundary loop " + std::to_string(k) +
                                " doesn't end in a cylinder of its own");
            }
            map.t[at(v)] = end.t;
            map.fixed[at(v)] = 1;
        }
    }
}

// The first map of the whole sweep mesh.
GraphMap sweep_map(const ReebGraph& reeb, const PantsGraph& pants) {
    const SweepMesh& mesh = reeb.mesh;
    GraphMap map;
    map.graph = pants.graph();
    map.fixed.assign(mesh.owner.size(), 0);
    std::vector<Spot> spots;
    for (std::size_t v = 0; v < mesh.owner.size(); ++v) {
        spots.push_back(pants.spot_of_vertex(static_cast<int>(v)));
        map.graph_edge.push_back(spots.back().edge);
        map.t.push_back(spots.back().t);
    }
    for (std::size_t e = 0; e < mesh.rings.edges.size(); ++e) {
        const MeshEdge& edge = mesh.rings.edges[e];
        const bool up = reeb.edge_runs_up[e] != 0;
        const Spot& low = spots[at(up ? edge.from : edge.to)];
        const Spot& high = spots[at(up ? edge.to : edge.from)];
        const Word word = word_of(pants, reeb, reeb.arcs_of_edge[e], low, high);
        map.words.push_back(up ? word : reversed(word));
    }
    for (std::size_t v = 0; v < mesh.owner.size(); ++v) {
        if (reeb.node_of_vertex[v] >= 0 && spots[v].node >= 0) {
            part_sectors(map, mesh.rings, static_cast<int>(v), spots[v].dart, mesh.owner[v]);
        }
    }
    return map;
}

// The map of the surface: added vertices are drawn onto their owners, caps are left out.
GraphMap without_added(const SweepMesh& mesh, GraphMap swept, const VertexRings& rings) {
    for (std::size_t v = mesh.owner.size(); v-- > at(mesh.surface_vertices);) {
        if (mesh.owner[v] >= 0) {
            draw_onto(swept, mesh.rings, static_cast<int>(v), mesh.owner[v]);
        }
    }
    const std::size_t count = rings.begin.size() - 1;
    GraphMap map;
    map.graph = std::move(swept.graph);
    map.graph_edge.assign(swept.graph_edge.begin(),
                          swept.graph_edge.begin() + static_cast<std::ptrdiff_t>(count));
    map.t.assign(swept.t.begin(), swept.t.begin() + static_cast<std::ptrdiff_t>(count));
    map.fixed.assign(count, 0);
    map.words.resize(rings.edges.size());
    std::vector<char> known(rings.edges.size(), 0);
    for (std::size_t e = 0; e < mesh.rings.edges.size(); ++e) {
        const int a = mesh.owner[at(mesh.rings.edges[e].from)];
        const int b = mesh.owner[at(mesh.rings.edges[e].to)];
        if (a < 0 || b < 0 || a == b) {
            continue;
        }
        const std::size_t edge = at(find_edge(rings, a, b));
        Word word =
            rings.edges[edge].from == a ? std::move(swept.words[e]) : reversed(swept.words[e]);
        if (known[edge] != 0 && map.words[edge] != word) {
            throw Error(ErrorKind::SelfCheck, "broken-tree",
                        "pants: a part of a saddle doesn't fit the others");
        }
        known[edge] = 1;
        map.words[edge] = std::move(word);
    }
    return map;
}

}  // namespace

void check_pants_graph(const MetricGraph& graph, int euler, int loops) {
    std::vector<int> degree(at(graph.nodes), 0);
    DisjointSets parts(at(graph.nodes));
    int joins = 0;
    for (const MetricGraph::Edge& edge : graph.edges) {
        ++degree[at(edge.from)];
        ++degree[at(edge.to)];
        joins +=
            parts.unite(static_cast<std::uint32_t>(edge.from), static_cast<std::uint32_t>(edge.to))
                ? 1
                : 0;
    }
    const auto pants = std::count(degree.begin(), degree.end(), 3);
    const auto ends = std::count(degree.begin(), degree.end(), 1);
    const bool connected = joins == graph.nodes - 1;
    if (pants != -euler || ends != loops || pants + ends != graph.nodes || !connected) {
        throw Error(
            ErrorKind::SelfCheck, "pants-graph",
            fmt::format("pants: the graph has {} nodes, {} of three legs instead of {}, {} ends "
                        "instead of {}{}",
                        graph.nodes, pants, -euler, ends, loops,
                        connected ? "" : ", and is not connected"));
    }
}

GraphMap initial_map(const ReebGraph& reeb,
                     const VertexRings& rings,
                     std::span<const std::vector<int>> boundary_loops) {
    const PantsGraph pants(reeb);
    const int faces = static_cast<int>(rings.edge_of_half_edge.size() / 3);
    const int euler =
        static_cast<int>(rings.begin.size()) - 1 - static_cast<int>(rings.edges.size()) + faces;
    check_pants_graph(pants.graph(), euler, static_cast<int>(boundary_loops.size()));
    GraphMap map = without_added(reeb.mesh, sweep_map(reeb, pants), rings);
    fix_boundaries(map, pants, reeb, boundary_loops);
    return map;
}

}  // namespace leafcutter::geometry
