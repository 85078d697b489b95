#include "geometry/pants/reeb_graph.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// The surface with every boundary loop closed by a fan; apices are the last vertices.
struct CappedSurface {
    std::vector<std::array<int, 3>> triangles;
    int vertices = 0;  // Without apices.
    HalfEdges half_edges;
    VertexRings rings;
    std::vector<int> rank;   // Per vertex and apex: its place in the sweep.
    std::vector<int> order;  // The inverse.
    std::vector<double> value;
};

CappedSurface cap(std::span<const std::array<int, 3>> triangles,
                  std::span<const double> values,
                  std::span<const std::vector<int>> loops) {
    CappedSurface capped;
    capped.triangles.assign(triangles.begin(), triangles.end());
    capped.vertices = static_cast<int>(values.size());
    capped.value.assign(values.begin(), values.end());
    for (const std::vector<int>& loop : loops) {
        const int apex = static_cast<int>(capped.value.size());
        double sum = 0.0;
        for (std::size_t i = 0; i < loop.size(); ++i) {
            capped.triangles.push_back({loop[(i + 1) % loop.size()], loop[i], apex});
            sum += values[at(loop[i])];
        }
        capped.value.push_back(sum / static_cast<double>(loop.size()));
    }
    const int count = static_cast<int>(capped.value.size());
    capped.half_edges = build_half_edges(capped.triangles, count);
    capped.rings = build_vertex_rings(capped.half_edges, count);
    return capped;
}

void rank_vertices(CappedSurface& capped, std::span<const char> loop_is_low) {
    const auto stage = [&](int v) {
        if (v < capped.vertices) {
            return 1;
        }
        return loop_is_low[at(v - capped.vertices)] != 0 ? 0 : 2;
    };
    capped.order.resize(capped.value.size());
    std::iota(capped.order.begin(), capped.order.end(), 0);
    std::sort(capped.order.begin(), capped.order.end(), [&](int a, int b) {
        return std::tuple(stage(a), capped.value[at(a)], a) <
               std::tuple(stage(b), capped.value[at(b)], b);
    });
    capped.rank.resize(capped.order.size());
    for (std::size_t i = 0; i < capped.order.size(); ++i) {
        capped.rank[at(capped.order[i])] = static_cast<int>(i);
    }
}

class Sweep {
public:
    explicit Sweep(const CappedSurface& capped) : capped_(capped) {
        graph_.arc_of_vertex.assign(capped.value.size(), -1);
        graph_.node_of_vertex.assign(capped.value.size(), -1);
        graph_.arcs_of_edge.resize(capped.rings.edges.size());
    }

    ReebGraph run() {
        for (const int v : capped_.order) {
            pass(v);
        }
        finish();
        return std::move(graph_);
    }

private:
    bool above(int a, int b) const { return capped_.rank[at(a)] > capped_.rank[at(b)]; }

    std::span<const RingSlot> ring(int v) const {
        const auto begin = at(capped_.rings.begin[at(v)]);
        return {capped_.rings.slots.data() + begin, at(capped_.rings.begin[at(v) + 1]) - begin};
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
                arc.high_value = capped_.value[at(v)];
            }
        }
        for (const RingSlot& slot : slots) {
            const bool fresh = graph_.arcs_of_edge[at(slot.edge)].empty();
            if (above(slot.neighbour, v) && fresh) {
                graph_.arcs.push_back({node, -1, capped_.value[at(v)], 0.0});
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
        const HalfEdges& h = capped_.half_edges;
        const int arc = static_cast<int>(graph_.arcs.size()) - 1;
        const int first = capped_.rings.edges[at(slot.edge)].half_edge;
        const int start = h.from_of(first) == v ? first : h.twin_of(first);
        int x = start;
        do {
            relabel(capped_.rings.edge_of_half_edge[at(x)], arc);
            const int apex = h.from_of(HalfEdges::previous(x));
            x = above(apex, v) ? h.twin_of(HalfEdges::previous(x)) : h.twin_of(HalfEdges::next(x));
        } while (x != start);
    }

    void finish() {
        graph_.edge_runs_up.resize(capped_.rings.edges.size());
        for (std::size_t e = 0; e < capped_.rings.edges.size(); ++e) {
            const MeshEdge& edge = capped_.rings.edges[e];
            graph_.edge_runs_up[e] = above(edge.to, edge.from) ? 1 : 0;
        }
        for (std::size_t apex = at(capped_.vertices); apex < capped_.value.size(); ++apex) {
            graph_.boundary_node.push_back(graph_.node_of_vertex[apex]);
        }
    }

    const CappedSurface& capped_;
    ReebGraph graph_;
};

}  // namespace

ReebGraph build_reeb_graph(std::span<const std::array<int, 3>> triangles,
                           std::span<const double> values,
                           std::span<const std::vector<int>> boundary_loops,
                           std::span<const char> loop_is_low) {
    CappedSurface capped = cap(triangles, values, boundary_loops);
    rank_vertices(capped, loop_is_low);
    return Sweep(capped).run();
}

}  // namespace leafcutter::geometry
