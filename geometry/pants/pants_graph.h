// The graph of a pants decomposition inside a Reeb graph: without the limbs that end in the surface
// and with chains joined to one edge each.

#pragma once

#include <cstddef>
#include <vector>

#include "geometry/pants/reeb_graph.h"
#include "geometry/pants/tree_word.h"

namespace leafcutter::geometry {

class PantsGraph {
public:
    // A point of the metric graph; `node` >= 0 says it is that node, seen from the start of `dart`.
    struct Spot {
        int edge = -1;
        double t = 0.0;
        int node = -1;  // Graph node, -1 inside an edge.
        Dart dart = -1;
    };

    explicit PantsGraph(const ReebGraph& reeb);  // Borrowed.

    const MetricGraph& graph() const { return graph_; }  // All weights 1.

    Spot spot_of_node(int reeb_node) const;
    // Vertices of limbs are where the limb hangs. A vertex that the sweep added, at a node, is seen
    // from the leg in which its owner lies.
    Spot spot_of_vertex(int v) const;

    // Limbs that start at parts of saddles of higher order that have a node of the graph among
    // their parts, but for those taken off already.
    std::vector<LimbAtSaddle> limbs_at_saddles() const;

    // The word of a mesh edge between two spots, from the arcs it runs through upwards.
    Word word_of(const std::vector<int>& arcs, const Spot& low, const Spot& high) const;

private:
    bool is_core(int arc) const { return pruned_[static_cast<std::size_t>(arc)] == 0; }
    Dart dart_up(int arc) const;  // The dart that an arc runs along, upwards.
    Spot seen_towards(int owner, int v, Spot spot) const;
    int limb_neighbour(int v) const;
    double arc_length(int arc) const;
    Spot spot_on_arc(int arc, double above_low) const;
    int other_end(int arc, int node) const;
    void prune();
    void name_graph_nodes();
    void join_chains();
    void follow_chain(int node, int arc);
    void name_first_dart(int graph_node, Dart dart);

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

// Throws Error(SelfCheck, "pants-graph") unless the graph is connected, with -`euler` nodes of
// three legs and `loops` of one: then it has 3g - 3 + 2b edges and g cycles.
void check_pants_graph(const MetricGraph& graph, int euler, int loops);

}  // namespace leafcutter::geometry
