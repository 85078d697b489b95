#include "geometry/pants/reeb_graph.h"

#include <algorithm>
#include <array>
#include <utility>

#include "geometry/pants/pants_graph.h"

namespace leafcutter::geometry {
namespace {

// Taking limbs off saddles may show new ones.
constexpr int kMostRounds = 8;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

class Sweep {
public:
    explicit Sweep(const SweepMesh& mesh) : mesh_(mesh) {
        graph_.arc_of_vertex.assign(mesh.value.size(), -1);
        graph_.node_of_vertex.assign(mesh.value.size(), -1);
        graph_.arcs_of_edge.resize(mesh.rings.edges.size());
    }

    ReebGraph run() {
        for (const int v : mesh_.order) {
            pass(v);
        }
        finish();
        return std::move(graph_);
    }

private:
    bool above(int a, int b) const { return mesh_.rank[at(a)] > mesh_.rank[at(b)]; }

    std::span<const RingSlot> ring(int v) const {
        const auto begin = at(mesh_.rings.begin[at(v)]);
        return {mesh_.rings.slots.data() + begin, at(mesh_.rings.begin[at(v) + 1]) - begin};
    }

    int label(int edge) const { return graph_.arcs_of_edge[at(edge)].back(); }
    void relabel(int edge, int arc) { graph_.arcs_of_edge[at(edge)].push_back(arc); }

    int upper_runs(int v) const {
        const auto slots = ring(v);
        int runs = 0;
        for (std::size_t k = 0; k < slots.size(); ++k) {
            const RingSlot& next = slots[(k + 1) % slots.size()];
            runs += !above(slots[k].neighbour, v) && above(next.neighbour, v) ? 1 : 0;
        }
        return runs;
    }

    void pass(int v) {
        const auto slots = ring(v);
        const bool any_up = std::any_of(slots.begin(), slots.end(),
                                        [&](const RingSlot& s) { return above(s.neighbour, v); });
        const bool any_down = std::any_of(
            slots.begin(), slots.end(), [&](const RingSlot& s) { return !above(s.neighbour, v); });
        if (any_up && any_down && upper_runs(v) == 1) {
            pass_regular(v);
            return;
        }
        const int node = static_cast<int>(graph_.node_vertex.size());
        graph_.node_vertex.push_back(v);
        graph_.node_of_vertex[at(v)] = node;
        for (const RingSlot& slot : slots) {
            if (!above(slot.neighbour, v)) {
                ReebArc& arc = graph_.arcs[at(label(slot.edge))];
                arc.high = node;
                arc.high_value = mesh_.value[at(v)];
            }
        }
        for (const RingSlot& slot : slots) {
            const bool fresh = graph_.arcs_of_edge[at(slot.edge)].empty();
            if (above(slot.neighbour, v) && fresh) {
                graph_.arcs.push_back({node, -1, mesh_.value[at(v)], 0.0});
                label_contour(v, slot);
            }
        }
    }

    void pass_regular(int v) {
        int arc = -1;
        for (const RingSlot& slot : ring(v)) {
            if (!above(slot.neighbour, v)) {
                arc = label(slot.edge);
                break;
            }
        }
        graph_.arc_of_vertex[at(v)] = arc;
        for (const RingSlot& slot : ring(v)) {
            if (above(slot.neighbour, v)) {
                relabel(slot.edge, arc);
            }
        }
    }

    // Gives the newest arc to every edge that the contour just above v through `slot` crosses.
    void label_contour(int v, const RingSlot& slot) {
        const HalfEdges& h = mesh_.half_edges;
        const int arc = static_cast<int>(graph_.arcs.size()) - 1;
        const int first = mesh_.rings.edges[at(slot.edge)].half_edge;
        const int start = h.from_of(first) == v ? first : h.twin_of(first);
        int x = start;
        do {
            relabel(mesh_.rings.edge_of_half_edge[at(x)], arc);
            const int apex = h.from_of(HalfEdges::previous(x));
            x = above(apex, v) ? h.twin_of(HalfEdges::previous(x)) : h.twin_of(HalfEdges::next(x));
        } while (x != start);
    }

    void finish() {
        graph_.edge_runs_up.resize(mesh_.rings.edges.size());
        for (std::size_t e = 0; e < mesh_.rings.edges.size(); ++e) {
            const MeshEdge& edge = mesh_.rings.edges[e];
            graph_.edge_runs_up[e] = above(edge.to, edge.from) ? 1 : 0;
        }
        for (std::size_t v = at(mesh_.surface_vertices);
             v < mesh_.owner.size() && mesh_.owner[v] < 0; ++v) {
            graph_.boundary_node.push_back(graph_.node_of_vertex[v]);
        }
    }

    const SweepMesh& mesh_;
    ReebGraph graph_;
};

}  // namespace

ReebGraph build_reeb_graph(std::span<const std::array<int, 3>> triangles,
                           std::span<const double> values,
                           std::span<const std::vector<int>> boundary_loops,
                           std::span<const char> loop_is_low,
                           int turn) {
    std::vector<LimbAtSaddle> limbs;
    for (int round = 0;; ++round) {
        SweepMesh mesh =
            make_sweep_mesh(triangles, values, boundary_loops, loop_is_low, {limbs, turn});
        ReebGraph graph = Sweep(mesh).run();
        graph.mesh = std::move(mesh);
        const std::vector<LimbAtSaddle> left = PantsGraph(graph).limbs_at_saddles();
        if (left.empty() || round == kMostRounds) {
            return graph;
        }
        limbs.insert(limbs.end(), left.begin(), left.end());
    }
}

}  // namespace leafcutter::geometry
