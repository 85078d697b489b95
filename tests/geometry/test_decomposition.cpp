// Pants decompositions: what graph they have, and that their first maps are in the class they say.

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/loops/edge_paths.h"
#include "geometry/loops/handle_tunnel.h"
#include "geometry/loops/linking.h"
#include "geometry/loops/user_loops.h"
#include "geometry/pants/decomposition.h"
#include "geometry/pants/harmonic_map.h"
#include "geometry/pants/reeb_graph.h"
#include "geometry/pants/slice.h"
#include "geometry/pants/split_long_edges.h"
#include "geometry/pants/tree_triangle.h"
#include "geometry/samples.h"
#include "tests/geometry/map_start.h"
#include "tests/geometry/prepared_surface.h"

namespace leafcutter::geometry {
namespace {

using testing::at;
using testing::PreparedSurface;

// Row T5: trivalent but for one end per boundary loop, as many nodes and edges as the genus asks
// for, connected.
void expect_pants_graph(const MetricGraph& graph, int genus, int loops) {
    const int pants = 2 * genus - 2 + loops;
    EXPECT_EQ(graph.nodes, pants + loops);
    EXPECT_EQ(static_cast<int>(graph.edges.size()), 3 * genus - 3 + 2 * loops);
    std::vector<int> degree(at(graph.nodes), 0);
    std::vector<int> part(at(graph.nodes));
    for (std::size_t n = 0; n < part.size(); ++n) {
        part[n] = static_cast<int>(n);
    }
    for (const MetricGraph::Edge& edge : graph.edges) {
        EXPECT_EQ(edge.weight, 1.0);
        ++degree[at(edge.from)];
        ++degree[at(edge.to)];
        std::replace(part.begin(), part.end(), int{part[at(edge.from)]}, int{part[at(edge.to)]});
    }
    EXPECT_EQ(std::count(degree.begin(), degree.end(), 3), pants);
    EXPECT_EQ(std::count(degree.begin(), degree.end(), 1), loops);
    EXPECT_EQ(std::count(part.begin(), part.end(), part.front()), graph.nodes);
}

void expect_first_map(const PreparedSurface& surface, const GraphMap& map) {
    expect_pants_graph(map.graph, surface.genus, static_cast<int>(surface.loops.size()));
    EXPECT_EQ(find_misfit(map, surface.rings), -1);
    for (const std::vector<int>& loop : surface.loops) {
        const int edge = map.graph_edge[at(loop.front())];
        for (const int v : loop) {
            EXPECT_EQ(map.graph_edge[at(v)], edge);
            EXPECT_EQ(map.fixed[at(v)], 1);
            EXPECT_TRUE(map.t[at(v)] == 0.0 || map.t[at(v)] == 1.0);
        }
    }
}

// Solves the map and slices the surface: every piece must be an annulus, which slice_surface
// checks, and there are as many three-prong points as Euler asks for.
void expect_solvable(const PreparedSurface& surface, GraphMap map) {
    TriangleMesh mesh = surface.mesh;
    VertexRings rings = surface.rings;
    std::vector<double> weights = surface.weights;
    bool resolved = false;
    for (int round = 0; round < 6 && !resolved; ++round) {
        solve_harmonic_map(map, rings, weights, round == 0 ? MapStart::Cold : MapStart::Warm, {});
        resolved = true;
        while (split_long_edges(mesh, rings, map) > 0) {
            resolved = false;
        }
        const int count = static_cast<int>(mesh.positions.size());
        weights.clear();
        for (const WeightedEdge& edge :
             positive_edges(mesh, build_half_edges(mesh.triangles, count), 1e-3)) {
            weights.push_back(edge.weight);
        }
    }
    ASSERT_TRUE(resolved);
    const Sliced sliced = slice_surface(mesh, rings, map);
    EXPECT_EQ(sliced.pieces.size(), map.graph.edges.size());
    const int loops = static_cast<int>(surface.loops.size());
    EXPECT_EQ(static_cast<int>(sliced.three_prongs.size()), 2 * (2 * surface.genus - 2 + loops));
}

// How often the way along a mesh edge passes the middle of graph edge k, signed.
int passes(const GraphMap& map, const MeshEdge& edge, const Word& word, int k) {
    const double middle = 0.5 * map.weight(k);
    const auto before = [&](int v) { return map.t[at(v)] < middle; };
    if (word.empty()) {
        return map.graph_edge[at(edge.from)] == k
                   ? (before(edge.from) ? 1 : 0) - (before(edge.to) ? 1 : 0)
                   : 0;
    }
    int sum = 0;
    for (std::size_t i = 0; i < word.size(); ++i) {
        const bool passed = edge_of(word[i]) == k &&
                            (i > 0 || before(edge.from) == runs_forward(word[i])) &&
                            (i + 1 < word.size() || before(edge.to) != runs_forward(word[i]));
        sum += passed ? (runs_forward(word[i]) ? 1 : -1) : 0;
    }
    return sum;
}

int passes_of_cycle(const PreparedSurface& surface,
                    const GraphMap& map,
                    const std::vector<int>& cycle,
                    int k) {
    int sum = 0;
    for (std::size_t i = 0; i < cycle.size(); ++i) {
        const int e = find_edge(surface.rings, cycle[i], cycle[(i + 1) % cycle.size()]);
        const MeshEdge& edge = surface.rings.edges[at(e)];
        const int sign = edge.from == cycle[i] ? 1 : -1;
        sum += sign * passes(map, edge, map.words[at(e)], k);
    }
    return sum;
}

constexpr SweepFunction kAll[] = {SweepFunction::Harmonic, SweepFunction::X, SweepFunction::Y,
                                  SweepFunction::Z, SweepFunction::Fiedler};

TEST(ReebGraph, OfNoiseIsTrivalentAndHasACycleForEachHandle) {
    for (int genus = 1; genus <= 3; ++genus) {
        const PreparedSurface surface(testing::make_chain_of_rings(genus, 2000));
        std::mt19937 random(static_cast<unsigned>(genus));
        std::vector<double> values(surface.mesh.positions.size());
        for (double& value : values) {
            value = std::uniform_real_distribution<double>()(random);
        }
        for (int turn = 0; turn < 3; ++turn) {
            const ReebGraph reeb = build_reeb_graph(surface.mesh.triangles, values, {}, {}, turn);
            EXPECT_GT(reeb.mesh.owner.size(), values.size()) << "no multiple saddle in all of it";
            std::vector<int> degree(reeb.node_vertex.size(), 0);
            for (const ReebArc& arc : reeb.arcs) {
                ++degree[at(arc.low)];
                ++degree[at(arc.high)];
            }
            EXPECT_TRUE(
                std::all_of(degree.begin(), degree.end(), [](int d) { return d == 1 || d == 3; }));
            EXPECT_EQ(static_cast<int>(reeb.arcs.size()) - static_cast<int>(degree.size()) + 1,
                      genus);
        }
    }
}

TEST(Decomposition, OfNoiseIsSolvable) {
    const PreparedSurface surface(testing::make_chain_of_rings(3, 3000));
    std::mt19937 random(7);
    std::vector<double> values(surface.mesh.positions.size());
    for (double& value : values) {
        value = std::uniform_real_distribution<double>()(random);
    }
    const ReebGraph reeb = build_reeb_graph(surface.mesh.triangles, values, {}, {});
    const GraphMap map = initial_map(reeb, surface.rings, {});
    expect_first_map(surface, map);
    expect_solvable(surface, map);
}

TEST(Decomposition, ByAnyFunctionIsSolvable) {
    std::vector<PreparedSurface> surfaces;
    surfaces.emplace_back(make_sample("eight", 2500));
    surfaces.emplace_back(testing::make_chain_of_rings(3, 3000));
    surfaces.emplace_back(testing::make_chain_of_rings(5, 6000));
    surfaces.emplace_back(testing::make_holed_sphere(6, 3000));
    for (const PreparedSurface& surface : surfaces) {
        SCOPED_TRACE(surface.genus);
        const auto candidates =
            pants_candidates(surface.view(), PantsSource::Reeb, SweepFunction::Auto, 0, {});
        EXPECT_EQ(candidates.size(), 5U);
        for (const PantsCandidate& candidate : candidates) {
            SCOPED_TRACE(candidate.name);
            expect_first_map(surface, candidate.map);
            expect_solvable(surface, candidate.map);
        }
    }
}

TEST(Decomposition, IsVariedByAttempts) {
    const PreparedSurface surface(make_sample("double-torus", 2500));
    for (int attempt = 0; attempt < 4; ++attempt) {
        for (const SweepFunction function : kAll) {
            const auto candidates =
                pants_candidates(surface.view(), PantsSource::Reeb, function, attempt, {});
            ASSERT_EQ(candidates.size(), 1U);
            expect_first_map(surface, candidates[0].map);
        }
    }
}

// A sheet with square holes one cell apart: edges join different boundary loops, and a loop to
// itself.
TEST(Decomposition, MayHaveBoundariesOneEdgeApart) {
    TriangleMesh mesh = testing::make_square(10);
    const auto is_hole = [](int i, int j) {
        return (j == 1 || j == 2) && (i == 1 || i == 2 || i == 4 || i == 5 || i == 7 || i == 8);
    };
    std::vector<std::array<int, 3>> kept;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const int cell = static_cast<int>(t / 2);
        if (!is_hole(cell % 10, cell / 10)) {
            kept.push_back(mesh.triangles[t]);
        }
    }
    mesh.triangles = kept;
    const PreparedSurface surface(testing::without_unused(mesh));
    ASSERT_EQ(surface.loops.size(), 4U);
    for (int attempt = 0; attempt < 4; ++attempt) {
        for (const PantsCandidate& candidate : pants_candidates(surface.view(), PantsSource::Reeb,
                                                                SweepFunction::Auto, attempt, {})) {
            SCOPED_TRACE(candidate.name);
            expect_first_map(surface, candidate.map);
        }
    }
}

// Each cut is the class of its graph edge: a cycle passes the edge's middle as often as it crosses
// the cut, which for loops of the other kind their linking numbers tell.
TEST(Decomposition, HasTheLoopsThatWereCut) {
    const PreparedSurface surface(testing::make_chain_of_rings(3, 4000));
    const LoopSystem loops = find_loops(surface.view(), {});
    const auto& on = surface.mesh.positions;
    const auto out = pushed_out(surface.mesh.triangles, on);
    const auto line = [](const std::vector<int>& cycle, const auto& places, double outwards,
                         const auto& outside) {
        std::vector<Eigen::Vector3d> points;
        for (const int v : cycle) {
            points.emplace_back(places[at(v)] + outwards * (outside[at(v)] - places[at(v)]));
        }
        return points;
    };
    for (const SweepFunction function : {SweepFunction::Harmonic, SweepFunction::Y}) {
        GraphMap map = pants_candidates(surface.view(loops.handle), PantsSource::HandleLoops,
                                        function, 0, {})[0]
                           .map;
        expect_first_map(surface, map);
        for (int k = 0; k < surface.genus; ++k) {
            for (const int v : loops.handle[at(k)]) {
                EXPECT_EQ(map.graph_edge[at(v)], k);
                EXPECT_EQ(map.t[at(v)], 0.5);
                EXPECT_EQ(map.fixed[at(v)], 0);
            }
        }
        solve_harmonic_map(map, surface.rings, surface.weights, MapStart::Cold, {});
        for (int k = 0; k < surface.genus; ++k) {
            int sign = 0;
            for (int j = 0; j < surface.genus; ++j) {
                EXPECT_EQ(passes_of_cycle(surface, map, loops.handle[at(j)], k), 0);
                const int crossed = *linking_number(line(loops.handle[at(k)], on, 0.0, out),
                                                    line(loops.tunnel[at(j)], on, -1.0, out));
                const int passed = passes_of_cycle(surface, map, loops.tunnel[at(j)], k);
                EXPECT_EQ(std::abs(passed), std::abs(crossed));
                sign = sign == 0 ? passed * crossed : sign;
                EXPECT_GE(sign * passed * crossed, 0);
            }
        }
        expect_solvable(surface, map);
    }
}

TEST(Decomposition, FindsItsOwnHandleAndTunnelLoops) {
    const PreparedSurface surface(make_sample("double-torus", 2500));
    for (const PantsSource source : {PantsSource::HandleLoops, PantsSource::TunnelLoops}) {
        const auto candidates =
            pants_candidates(surface.view(), source, SweepFunction::Auto, 0, {});
        EXPECT_EQ(candidates.size(), 5U);
        for (const PantsCandidate& candidate : candidates) {
            SCOPED_TRACE(candidate.name);
            expect_first_map(surface, candidate.map);
            expect_solvable(surface, candidate.map);
        }
    }
}

// A ring of vertices near a plane, in order round the x axis.
std::vector<int> vertices_near_plane(const PreparedSurface& surface, double x, int count) {
    std::vector<int> ring(at(count), -1);
    std::vector<double> best(at(count), 1e9);
    for (std::size_t v = 0; v < surface.mesh.positions.size(); ++v) {
        const Eigen::Vector3d& p = surface.mesh.positions[v];
        const double turn = std::atan2(p.z(), p.y()) / (2.0 * std::numbers::pi) + 0.5;
        const double off = std::abs(turn * count - std::floor(turn * count) - 0.5);
        const std::size_t sector = at(static_cast<int>(turn * count) % count);
        const double distance = std::abs(p.x() - x) + 0.05 * off;
        if (distance < best[sector]) {
            best[sector] = distance;
            ring[sector] = static_cast<int>(v);
        }
    }
    return ring;
}

TEST(Decomposition, TakesALoopThatSeparates) {
    const PreparedSurface surface(make_sample("double-torus", 4000));
    const std::vector<std::vector<int>> given{vertices_near_plane(surface, 0.0, 8)};
    const auto cuts = close_loops(surface.rings, surface.mesh.positions, given, {});
    for (const PantsCandidate& candidate :
         pants_candidates(surface.view(cuts), PantsSource::User, SweepFunction::Auto, 0, {})) {
        SCOPED_TRACE(candidate.name);
        expect_first_map(surface, candidate.map);
        const auto& edges = candidate.map.graph.edges;
        EXPECT_NE(edges[0].from, edges[0].to);  // The waist, between two one-holed tori.
        EXPECT_EQ(edges[1].from, edges[1].to);
        EXPECT_EQ(edges[2].from, edges[2].to);
        expect_solvable(surface, candidate.map);
    }
}

std::string code_of(const PreparedSurface& surface, const std::vector<std::vector<int>>& cuts) {
    try {
        pants_candidates(surface.view(cuts), PantsSource::User, SweepFunction::X, 0, {});
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::BadOption);
        EXPECT_NE(std::string(error.what()).find("loops[0]"), std::string::npos);
        return error.code();
    }
    return "none";
}

TEST(Decomposition, RefusesLoopsThatAreNoPantsCurves) {
    const PreparedSurface surface(make_sample("double-torus", 4000));
    std::vector<int> round_vertex;
    for (int k = surface.rings.begin[50]; k < surface.rings.begin[51]; ++k) {
        round_vertex.push_back(surface.rings.slots[at(k)].neighbour);
    }
    EXPECT_EQ(code_of(surface, {round_vertex}), "loop-not-essential");
    const std::vector<std::vector<int>> parallel{vertices_near_plane(surface, 0.0, 8),
                                                 vertices_near_plane(surface, 0.18, 8)};
    const auto cuts = close_loops(surface.rings, surface.mesh.positions, parallel, {});
    EXPECT_EQ(code_of(surface, cuts), "loops-homotopic");
}

class SharedDecomposition : public ::testing::TestWithParam<const char*> {};

TEST_P(SharedDecomposition, HasTheRightGraphForEveryFunction) {
    const auto mesh = testing::read_shared(GetParam());
    if (!mesh) {
        GTEST_SKIP() << "no shared data";
    }
    const PreparedSurface surface(*mesh);
    const auto candidates =
        pants_candidates(surface.view(), PantsSource::Reeb, SweepFunction::Auto, 0, {});
    EXPECT_EQ(candidates.size(), 5U);
    for (const PantsCandidate& candidate : candidates) {
        SCOPED_TRACE(candidate.name);
        expect_first_map(surface, candidate.map);
    }
}

INSTANTIATE_TEST_SUITE_P(Shared,
                         SharedDecomposition,
                         ::testing::Values("eight-7k.off",
                                           "3holes.off",
                                           "fertility.off",
                                           "boot.obj",
                                           "cat-7-boundaries.obj",
                                           "plane-windows.obj",
                                           "hand-6-boundaries.obj"),
                         [](const auto& tested) {
                             std::string name = tested.param;
                             name.resize(name.find('.'));
                             std::erase(name, '-');
                             return name;
                         });

}  // namespace
}  // namespace leafcutter::geometry
