#include "geometry/pants/pants_graph.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <fmt/format.h>

#include "geometry/disjoint_sets.h"
#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

}  // namespace

PantsGraph::PantsGraph(const ReebGraph& reeb) : reeb_(reeb), arcs_at_(reeb.node_vertex.size()) {
    prune();
    name_graph_nodes();
    join_chains();
}

Dart PantsGraph::dart_up(int arc) const {
    return 2 * chain_of_[at(arc)] + (with_chain_[at(arc)] ? 0 : 1);
}

PantsGraph::Spot PantsGraph::spot_of_node(int node) const {
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

PantsGraph::Spot PantsGraph::spot_of_vertex(int v) const {
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

// The spot of a vertex at a graph node, on the leg in which its neighbour `owner` lies.
PantsGraph::Spot PantsGraph::seen_towards(int owner, int v, Spot spot) const {
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

double PantsGraph::arc_length(int arc) const {
    return std::max(reeb_.arcs[at(arc)].high_value - reeb_.arcs[at(arc)].low_value, 0.0);
}

PantsGraph::Spot PantsGraph::spot_on_arc(int arc, double above_low) const {
    const double along = with_chain_[at(arc)] ? above_low : arc_length(arc) - above_low;
    const double length = chain_length_[at(chain_of_[at(arc)])];
    const double t = length > 0.0 ? (chain_offset_[at(arc)] + along) / length : 0.5;
    return {chain_of_[at(arc)], std::clamp(t, 0.0, 1.0), -1, -1};
}

int PantsGraph::other_end(int arc, int node) const {
    const ReebArc& a = reeb_.arcs[at(arc)];
    return a.low == node ? a.high : a.low;
}

// Takes away trees that hang from the core, leaf by leaf; boundary caps stay.
void PantsGraph::prune() {
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

void PantsGraph::name_graph_nodes() {
    graph_node_.assign(arcs_at_.size(), -1);
    for (std::size_t n = 0; n < degree_.size(); ++n) {
        if (degree_[n] == 1 || degree_[n] >= 3) {
            graph_node_[n] = graph_.nodes++;
        }
    }
    first_dart_.assign(at(graph_.nodes), -1);
}

void PantsGraph::join_chains() {
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

void PantsGraph::follow_chain(int node, int arc) {
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

void PantsGraph::name_first_dart(int graph_node, Dart dart) {
    if (first_dart_[at(graph_node)] < 0) {
        first_dart_[at(graph_node)] = dart;
    }
}

std::vector<LimbAtSaddle> PantsGraph::limbs_at_saddles() const {
    const SweepMesh& mesh = reeb_.mesh;
    std::vector<char> has_graph_node(mesh.owner.size(), 0);  // Per owner.
    std::vector<char> is_parted(mesh.owner.size(), 0);
    for (std::size_t v = 0; v < mesh.owner.size(); ++v) {
        if (mesh.owner[v] < 0) {
            continue;
        }
        const std::size_t owner = at(mesh.owner[v]);
        const int node = reeb_.node_of_vertex[v];
        is_parted[owner] = is_parted[owner] != 0 || v != owner ? 1 : 0;
        if (node >= 0 && graph_node_[at(node)] >= 0) {
            has_graph_node[owner] = 1;
        }
    }
    std::vector<LimbAtSaddle> limbs;
    for (std::size_t v = 0; v < mesh.owner.size(); ++v) {
        const int owner = mesh.owner[v];
        if (owner < 0 || mesh.keeps_limbs[v] != 0 || is_parted[at(owner)] == 0 ||
            has_graph_node[at(owner)] == 0) {
            continue;
        }
        const int towards = limb_neighbour(static_cast<int>(v));
        if (towards >= 0) {
            limbs.push_back({owner, towards});
        }
    }
    return limbs;
}

// The owner of a neighbour of node vertex `v` in a limb that hangs at v, or -1.
int PantsGraph::limb_neighbour(int v) const {
    const int node = reeb_.node_of_vertex[at(v)];
    if (node < 0 || degree_[at(node)] < 2) {
        return -1;  // Not a node, or in a limb itself.
    }
    const VertexRings& rings = reeb_.mesh.rings;
    for (int k = rings.begin[at(v)]; k < rings.begin[at(v) + 1]; ++k) {
        const RingSlot& slot = rings.slots[at(k)];
        const std::vector<int>& arcs = reeb_.arcs_of_edge[at(slot.edge)];
        const bool up = (reeb_.edge_runs_up[at(slot.edge)] != 0) == slot.forward;
        const int owner = reeb_.mesh.owner[at(slot.neighbour)];
        if (!is_core(up ? arcs.front() : arcs.back()) && owner >= 0 &&
            owner != reeb_.mesh.owner[at(v)]) {
            return owner;
        }
    }
    return -1;
}

Word PantsGraph::word_of(const std::vector<int>& arcs, const Spot& low, const Spot& high) const {
    Word word;
    for (const int arc : arcs) {
        if (!is_core(arc)) {
            continue;
        }
        const bool through_node = graph_node_[at(reeb_.arcs[at(arc)].low)] >= 0;
        if (word.empty() || through_node) {
            word.push_back(dart_up(arc));
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

}  // namespace leafcutter::geometry
