#include "geometry/pants/initial_map.h"

#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/loops/edge_paths.h"
#include "geometry/pants/draw_onto.h"
#include "geometry/pants/pants_graph.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

struct Saddle {
    int vertex = 0;
    Dart own = -1;  // Leaves the node along the vertex's own edge.
    int keep = -1;
};

// Ring slots of a saddle that see the same leg in several sectors lie on different edges of the
// tree: all get an essential backtrack but one, that with the neighbour `keep` if there is one.
void part_sectors(GraphMap& map, const VertexRings& rings, const Saddle& saddle) {
    const Dart own = saddle.own;
    const auto begin = at(rings.begin[at(saddle.vertex)]);
    const std::size_t count = at(rings.begin[at(saddle.vertex) + 1]) - begin;
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
    while (shift < count && rings.slots[begin + shift].neighbour != saddle.keep) {
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
        const PantsGraph::Spot end = pants.spot_of_node(reeb.boundary_node[k]);
        for (const int v : loops[k]) {
            if (end.node < 0 || map.graph_edge[at(v)] != end.edge) {
                throw Error(
                    ErrorKind::SelfCheck, "pants-graph",
                    fmt::format("pants: boundary loop {} doesn't end in a cylinder of its own", k));
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
    std::vector<PantsGraph::Spot> spots;
    for (std::size_t v = 0; v < mesh.owner.size(); ++v) {
        spots.push_back(pants.spot_of_vertex(static_cast<int>(v)));
        map.graph_edge.push_back(spots.back().edge);
        map.t.push_back(spots.back().t);
    }
    for (std::size_t e = 0; e < mesh.rings.edges.size(); ++e) {
        const MeshEdge& edge = mesh.rings.edges[e];
        const bool up = reeb.edge_runs_up[e] != 0;
        const PantsGraph::Spot& low = spots[at(up ? edge.from : edge.to)];
        const PantsGraph::Spot& high = spots[at(up ? edge.to : edge.from)];
        const Word word = pants.word_of(reeb.arcs_of_edge[e], low, high);
        map.words.push_back(up ? word : reversed(word));
    }
    for (std::size_t v = 0; v < mesh.owner.size(); ++v) {
        if (reeb.node_of_vertex[v] >= 0 && spots[v].node >= 0) {
            part_sectors(map, mesh.rings, {static_cast<int>(v), spots[v].dart, mesh.owner[v]});
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
