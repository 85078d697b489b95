// Algorithm 1 with both distances: its parts against hand and brute force, the solver against it,
// and what goes wrong with the distance of the graph itself.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/pants/graph_metric.h"
#include "geometry/pants/harmonic_map.h"
#include "geometry/pants/heat_flow.h"
#include "geometry/pants/local_step.h"
#include "tests/geometry/map_start.h"

namespace leafcutter::geometry {
namespace {

using testing::at;

constexpr int kFaces = 2000;

// Edges out of node 0, each to an end of its own.
MetricGraph star(const std::vector<double>& legs) {
    MetricGraph graph;
    graph.nodes = 1 + static_cast<int>(legs.size());
    for (std::size_t k = 0; k < legs.size(); ++k) {
        graph.edges.push_back({.from = 0, .to = static_cast<int>(k) + 1, .weight = legs[k]});
    }
    return graph;
}

MetricGraph barbell() {
    return {.nodes = 2,
            .edges = {{.from = 0, .to = 0, .weight = 1.0},
                      {.from = 0, .to = 1, .weight = 0.4},
                      {.from = 1, .to = 1, .weight = 2.0}}};
}

MetricGraph theta() {
    return {.nodes = 2,
            .edges = {{.from = 0, .to = 1, .weight = 1.0},
                      {.from = 0, .to = 1, .weight = 0.7},
                      {.from = 1, .to = 0, .weight = 2.5}}};
}

// Vertices 0 to 5: the ends of three axes, two by two.
TriangleMesh octahedron() {
    TriangleMesh mesh;
    for (int axis = 0; axis < 3; ++axis) {
        mesh.positions.push_back(Eigen::Vector3d::Unit(axis));
        mesh.positions.push_back(-Eigen::Vector3d::Unit(axis));
    }
    for (const int x : {0, 1}) {
        for (const int y : {2, 3}) {
            for (const int z : {4, 5}) {
                if ((x + y + z) % 2 == 0) {
                    mesh.triangles.push_back({x, y, z});
                } else {
                    mesh.triangles.push_back({y, x, z});
                }
            }
        }
    }
    return mesh;
}

struct Placed {
    TriangleMesh mesh;
    VertexRings rings;
    std::vector<double> weights;
    GraphMap map;
};

// Vertices at given places, mesh edges along shortest paths.
Placed place(TriangleMesh mesh, const MetricGraph& graph, const std::vector<GraphPoint>& points) {
    Placed placed;
    placed.mesh = std::move(mesh);
    const int count = static_cast<int>(placed.mesh.positions.size());
    const HalfEdges half_edges = build_half_edges(placed.mesh.triangles, count);
    placed.rings = build_vertex_rings(half_edges, count);
    for (const WeightedEdge& edge : positive_edges(placed.mesh, half_edges, 1e-3)) {
        placed.weights.push_back(edge.weight);
    }
    placed.map.graph = graph;
    placed.map.fixed.assign(points.size(), 0);
    for (const GraphPoint& point : points) {
        placed.map.graph_edge.push_back(point.edge);
        placed.map.t.push_back(point.t);
    }
    const GraphMetric metric(graph);
    for (const MeshEdge& edge : placed.rings.edges) {
        placed.map.words.push_back(
            metric.shortest_path(points[at(edge.from)], points[at(edge.to)]));
    }
    return placed;
}

TEST(HeatFlow, EnergyOfEightTrianglesIsTheOneByHand) {
    // All angles are 60 degrees, so all weights 1 / sqrt(3). Axes lie on legs of a star; ends of
    // one axis aren't joined. Squared distances, axis by axis: 5.375 + 7.375 + 11.5 = 24.25.
    Placed placed = place(octahedron(), star({1.0, 2.0, 3.0}),
                          {{0, 0.5}, {0, 0.25}, {1, 1.0}, {1, 0.5}, {2, 1.5}, {2, 0.0}});
    for (const double weight : placed.weights) {
        EXPECT_NEAR(weight, 1.0 / std::sqrt(3.0), 1e-14);
    }
    const double by_hand = 24.25 / (2.0 * std::sqrt(3.0));
    EXPECT_NEAR(map_energy(placed.map, placed.rings, placed.weights), by_hand, 1e-12);
    EXPECT_NEAR(graph_distance_energy(placed.map, placed.rings, placed.weights), by_hand, 1e-12);

    // One edge from x (0.5 from the node) to y, now on the same leg 0.75 from it: straight, that is
    // 0.25. A path that goes to the node and back is 1.25 long in the tree.
    const auto edge =
        std::find_if(placed.rings.edges.begin(), placed.rings.edges.end(), [](const MeshEdge& e) {
            return std::min(e.from, e.to) == 0 && std::max(e.from, e.to) == 2;
        });
    ASSERT_NE(edge, placed.rings.edges.end());
    placed.map.graph_edge[2] = 0;
    placed.map.t[2] = 0.75;
    Word& word = placed.map.words[static_cast<std::size_t>(edge - placed.rings.edges.begin())];
    word.clear();
    const double straight = map_energy(placed.map, placed.rings, placed.weights);
    word = {1, 0};
    const double essential = map_energy(placed.map, placed.rings, placed.weights);
    EXPECT_NEAR(essential - straight, (1.25 * 1.25 - 0.25 * 0.25) / (2.0 * std::sqrt(3.0)), 1e-12);
}

TEST(GraphMetric, FindsWaysRoundLoopsAndParallelEdges) {
    const GraphMetric bar(barbell());
    EXPECT_DOUBLE_EQ(bar.distance({0, 0.1}, {0, 0.9}), 0.2);  // Over the node.
    EXPECT_DOUBLE_EQ(bar.distance({0, 0.3}, {0, 0.6}), 0.3);
    EXPECT_DOUBLE_EQ(bar.distance({0, 0.3}, {2, 1.5}), 0.3 + 0.4 + 0.5);
    EXPECT_EQ(bar.shortest_path({0, 0.3}, {2, 1.5}), (Word{1, 2, 5}));
    EXPECT_EQ(bar.shortest_path({0, 0.9}, {0, 0.1}), (Word{0, 0}));
    EXPECT_TRUE(bar.shortest_path({0, 0.3}, {0, 0.6}).empty());
    const GraphMetric two(theta());
    EXPECT_DOUBLE_EQ(two.distance({2, 0.2}, {2, 2.3}), 0.2 + 0.7 + 0.2);
    EXPECT_EQ(two.shortest_path({2, 0.2}, {2, 2.3}), (Word{5, 3, 5}));
}

// No point of a fine sampling of the graph beats the centre.
void expect_best(const MetricGraph& graph,
                 const std::vector<WeightedPoint>& points,
                 GraphPoint centre) {
    constexpr int kSamples = 2000;
    const GraphMetric metric(graph);
    const double least = metric.moment(points, centre);
    for (int e = 0; e < static_cast<int>(graph.edges.size()); ++e) {
        for (int k = 0; k <= kSamples; ++k) {
            const double t = graph.edges[at(e)].weight * k / kSamples;
            ASSERT_LE(least, metric.moment(points, {e, t}) * (1.0 + 1e-12) + 1e-15)
                << "edge " << e << " at " << t << " beats edge " << centre.edge << " at "
                << centre.t;
        }
    }
}

TEST(GraphMetric, CentreIsTheBestOfBruteForce) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    for (const MetricGraph& graph : {star({1.0, 0.3, 2.0, 0.8}), barbell(), theta()}) {
        for (int round = 0; round < 25; ++round) {
            std::vector<WeightedPoint> points(3 + random() % 5);
            const double spread = round % 2 == 0 ? 1.0 : 0.1;  // All over, or about a node.
            for (WeightedPoint& one : points) {
                one.point.edge = static_cast<int>(random() % graph.edges.size());
                one.point.t = spread * share(random) * graph.edges[at(one.point.edge)].weight;
                one.weight = 0.05 + share(random);
            }
            expect_best(graph, points, GraphMetric(graph).geodesic_centre(points, 0));
        }
    }
}

// A vertex at the hub of a fan whose rim lies leg by leg on a star.
Placed fan_on_star(std::mt19937& random) {
    std::uniform_real_distribution<double> share(0.0, 1.0);
    const MetricGraph graph = star({1.0, 0.6, 2.0});
    const int spokes = 7;
    TriangleMesh mesh;
    mesh.positions.emplace_back(0.0, 0.0, 0.0);
    std::vector<GraphPoint> points{{static_cast<int>(random() % 3), 0.0}};
    points[0].t = share(random) * graph.edges[at(points[0].edge)].weight;
    for (int k = 0; k < spokes; ++k) {
        const double angle = 2.0 * std::numbers::pi * (k + 0.4 * share(random)) / spokes;
        mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
        mesh.triangles.push_back({0, 1 + k, 1 + (k + 1) % spokes});
        const int leg = 3 * k / spokes;
        points.push_back({leg, share(random) * graph.edges[at(leg)].weight});
    }
    return place(std::move(mesh), graph, points);
}

TEST(LocalStep, PutsAVertexAtTheCentreOfAStar) {
    std::mt19937 random(11);
    int stuck = 0;
    int elsewhere = 0;
    for (int round = 0; round < 200; ++round) {
        SCOPED_TRACE(round);
        Placed fan = fan_on_star(random);
        const int before = fan.map.graph_edge[0];
        std::vector<WeightedPoint> neighbours;
        for (int k = fan.rings.begin[0]; k < fan.rings.begin[1]; ++k) {
            const RingSlot& slot = fan.rings.slots[at(k)];
            neighbours.push_back(
                {{fan.map.graph_edge[at(slot.neighbour)], fan.map.t[at(slot.neighbour)]},
                 fan.weights[at(slot.edge)]});
        }
        const Standing standing = LocalStep(fan.map, fan.rings, fan.weights).centre(0);
        const GraphPoint centre{fan.map.graph_edge[0], fan.map.t[0]};
        expect_best(fan.map.graph, neighbours, centre);
        EXPECT_NE(standing, Standing::Blocked);
        stuck += standing == Standing::Stuck ? 1 : 0;
        elsewhere += centre.edge != before ? 1 : 0;
        for (int k = fan.rings.begin[0]; k < fan.rings.begin[1]; ++k) {
            const RingSlot& slot = fan.rings.slots[at(k)];
            const Word& word = fan.map.words[at(slot.edge)];
            EXPECT_NEAR(fan.map.distance(0, slot.neighbour, slot.forward ? word : reversed(word)),
                        GraphMetric(fan.map.graph)
                            .distance(centre, {fan.map.graph_edge[at(slot.neighbour)],
                                               fan.map.t[at(slot.neighbour)]}),
                        1e-12);
        }
    }
    EXPECT_GT(stuck, 10);      // The node itself is the centre often enough ...
    EXPECT_GT(elsewhere, 50);  // ... and another leg.
}

struct Surface {
    const char* name;
    std::function<TriangleMesh()> make;
    int axis = 0;
};

std::vector<Surface> surfaces() {
    return {{"eight", [] { return make_sample("eight", kFaces); }, 0},
            {"eight across", [] { return make_sample("eight", kFaces); }, 1},
            {"double torus", [] { return make_sample("double-torus", kFaces); }, 0},
            {"three holes", [] { return testing::make_holed_sphere(3, kFaces); }, 0},
            {"five holes", [] { return testing::make_holed_sphere(5, 2 * kFaces); }, 0}};
}

void expect_falling(const HeatFlowReport& report) {
    ASSERT_GT(report.sweeps(), 0);
    for (std::size_t k = 1; k < report.energies.size(); ++k) {
        ASSERT_LE(report.energies[k], report.energies[k - 1] * (1.0 + 1e-13)) << "sweep " << k;
    }
}

TEST(HeatFlow, NoSweepRaisesTheEnergy) {
    for (const Surface& surface : surfaces()) {
        for (const TargetDistance distance : {TargetDistance::Tree, TargetDistance::Graph}) {
            SCOPED_TRACE(surface.name);
            testing::MapStart start = testing::start_map(surface.make(), surface.axis);
            const HeatFlowReport report = heat_flow(start.map, start.rings, start.weights,
                                                    {.distance = distance, .most_sweeps = 300}, {});
            expect_falling(report);
            EXPECT_LT(report.energy(), 0.9 * report.energies.front());
        }
    }
}

TEST(HeatFlow, StopsWhereAskedTo) {
    testing::MapStart start = testing::start_map(make_sample("eight", 500), 0);
    GraphMap map = start.map;
    const HeatFlowReport few =
        heat_flow(map, start.rings, start.weights, {.tolerance = 0.0, .most_sweeps = 7}, {});
    EXPECT_EQ(few.sweeps(), 7);
    EXPECT_FALSE(few.converged);
    map = start.map;
    const HeatFlowReport all = heat_flow(map, start.rings, start.weights, {.tolerance = 1e-6}, {});
    EXPECT_TRUE(all.converged);
    const double last = all.energies[all.energies.size() - 2];
    EXPECT_LT(last - all.energy(), 1e-6 * last);
    EXPECT_LT(all.residual, few.residual);
    std::stop_source source;
    source.request_stop();
    Context stopped;
    stopped.stop = source.get_token();
    EXPECT_THROW(heat_flow(map, start.rings, start.weights, {}, stopped), Cancelled);
}

TEST(HarmonicMap, ReachesTheMinimumOfAlgorithmOne) {
    for (const Surface& surface : surfaces()) {
        SCOPED_TRACE(surface.name);
        testing::MapStart start = testing::start_map(surface.make(), surface.axis);
        GraphMap flowing = start.map;
        const HeatFlowReport flow =
            heat_flow(flowing, start.rings, start.weights, {.tolerance = 1e-13}, {});
        EXPECT_TRUE(flow.converged);
        expect_falling(flow);
        GraphMap solved = start.map;
        const HarmonicMapReport report =
            solve_harmonic_map(solved, start.rings, start.weights, MapStart::Cold, {});
        EXPECT_TRUE(report.converged);
        EXPECT_NEAR(report.energy / flow.energy(), 1.0, 1e-8);
        EXPECT_NEAR(map_energy(solved, start.rings, start.weights) / report.energy, 1.0, 1e-12);
        EXPECT_LT(20 * report.iterations, flow.sweeps());
        // Not only the energy: the map.
        double longest = 0.0;
        for (const MetricGraph::Edge& edge : solved.graph.edges) {
            longest = std::max(longest, edge.weight);
        }
        const GraphMetric metric(solved.graph);
        for (std::size_t v = 0; v < solved.t.size(); ++v) {
            ASSERT_LT(metric.distance({solved.graph_edge[v], solved.t[v]},
                                      {flowing.graph_edge[v], flowing.t[v]}),
                      1e-4 * longest);
        }
    }
}

TEST(HarmonicMap, IsTheSameFromEveryStart) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> anywhere(0.01, 0.99);
    for (const Surface& surface : surfaces()) {
        SCOPED_TRACE(surface.name);
        testing::MapStart start = testing::start_map(surface.make(), surface.axis);
        GraphMap scrambled = start.map;
        for (std::size_t v = 0; v < scrambled.t.size(); ++v) {
            if (scrambled.fixed[v] == 0) {
                scrambled.t[v] = anywhere(random) * scrambled.weight(scrambled.graph_edge[v]);
            }
        }
        const HeatFlowReport flow =
            heat_flow(scrambled, start.rings, start.weights, {.tolerance = 1e-13}, {});
        const HarmonicMapReport straight =
            solve_harmonic_map(start.map, start.rings, start.weights, MapStart::Cold, {});
        EXPECT_NEAR(flow.energy() / straight.energy, 1.0, 1e-8);
    }
}

bool all_annuli(const testing::Preimages& pieces) {
    return std::all_of(
        pieces.of_edge.begin(), pieces.of_edge.end(),
        [](const testing::Preimage& piece) { return piece.components == 1 && piece.euler == 0; });
}

struct Compared {
    double tree_energy = 0.0;
    double graph_energy = 0.0;
    testing::Preimages tree;
    testing::Preimages graph;
};

// The minima of the two energies, with `link` the weight of edges between different nodes.
Compared compare_distances(const char* sample, int axis, double link) {
    testing::MapStart start = testing::start_map(make_sample(sample, kFaces), axis);
    testing::set_link_weights(start.map, link);
    Compared result;
    result.tree_energy =
        solve_harmonic_map(start.map, start.rings, start.weights, MapStart::Cold, {}).energy;
    result.tree = testing::preimages(start, start.map);
    const HeatFlowReport flow =
        heat_flow(start.map, start.rings, start.weights,
                  {.distance = TargetDistance::Graph, .tolerance = 1e-12}, {});
    EXPECT_TRUE(flow.converged);
    expect_falling(flow);
    result.graph_energy = flow.energy();
    const GraphMetric metric(start.map.graph);
    for (std::size_t e = 0; e < start.rings.edges.size(); ++e) {
        const auto point = [&](int v) {
            return GraphPoint{start.map.graph_edge[at(v)], start.map.t[at(v)]};
        };
        start.map.words[e] =
            metric.shortest_path(point(start.rings.edges[e].from), point(start.rings.edges[e].to));
    }
    result.graph = testing::preimages(start, start.map);
    for (const testing::Preimages* found : {&result.tree, &result.graph}) {
        EXPECT_EQ(found->torn, 0);
        EXPECT_EQ(found->long_words, 0);
    }
    return result;
}

// Taken literally, section 3.3 measures along the graph. Two sheets of a cylinder that meet along
// the critical graph are near each other there, so the sheets are pulled into one: the energy falls
// below the tree's and what should be a cylinder gets two more holes.
TEST(HeatFlow, DistanceInTheGraphBreaksACylinder) {
    for (const char* sample : {"eight", "double-torus"}) {
        for (const int axis : {0, 1}) {  // A barbell, a theta.
            SCOPED_TRACE(std::string(sample) + " axis " + std::to_string(axis));
            const Compared found = compare_distances(sample, axis, 1.0);
            EXPECT_LT(found.graph_energy, 0.99 * found.tree_energy);
            EXPECT_TRUE(all_annuli(found.tree));
            EXPECT_EQ(found.tree.three_prongs, 4);  // 4g - 4
            EXPECT_FALSE(all_annuli(found.graph));
            EXPECT_EQ(found.graph.three_prongs, 0);
            int euler = 0;
            int least = 0;
            for (const testing::Preimage& piece : found.graph.of_edge) {
                euler += piece.euler;
                least = std::min(least, piece.euler);
            }
            EXPECT_EQ(euler, -2);  // All of the surface's: nothing is left for the nodes.
            EXPECT_EQ(least, -2);
        }
    }
}

TEST(HeatFlow, DistancesAgreeWhereTheMiddleIsShort) {
    for (const char* sample : {"eight", "double-torus"}) {
        SCOPED_TRACE(sample);
        const Compared found = compare_distances(sample, 0, 0.16);
        EXPECT_NEAR(found.graph_energy / found.tree_energy, 1.0, 1e-8);
        EXPECT_TRUE(all_annuli(found.tree));
        EXPECT_TRUE(all_annuli(found.graph));
        EXPECT_EQ(found.graph.three_prongs, 4);
    }
}

}  // namespace
}  // namespace leafcutter::geometry
