// What a user may ask of where things lie: singular points near places, ways round the surface that
// no cylinder goes, loops of which only some are given.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/foliation.h"
#include "geometry/loops/edge_paths.h"
#include "geometry/loops/holonomy.h"
#include "geometry/reached_points.h"
#include "geometry/samples.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;
using testing::to_mesh;
using Loop = std::vector<int>;

// "holes": a sphere with five holes; else a sample.
TriangleMesh surface(const std::string& name, int faces) {
    if (name != "holes") {
        return make_sample(name, faces);
    }
    const TriangleMesh sphere = make_sample("sphere", faces);
    const std::array<Eigen::Vector3d, 5> centres{Eigen::Vector3d{1.0, 0.1, 0.2},
                                                 {-0.8, 0.6, 0.1},
                                                 {-0.5, -0.9, 0.3},
                                                 {0.2, 0.3, 1.0},
                                                 {0.1, -0.2, -1.0}};
    TriangleMesh mesh;
    std::vector<int> fresh(sphere.positions.size(), -1);
    for (const auto& t : sphere.triangles) {
        const bool is_out = std::any_of(t.begin(), t.end(), [&](int v) {
            const Eigen::Vector3d p = sphere.positions[at(v)].normalized();
            return std::any_of(centres.begin(), centres.end(),
                               [&](const auto& c) { return p.dot(c.normalized()) > 0.97; });
        });
        for (const int v : t) {
            if (!is_out && fresh[at(v)] < 0) {
                fresh[at(v)] = static_cast<int>(mesh.positions.size());
                mesh.positions.push_back(sphere.positions[at(v)]);
            }
        }
        if (!is_out) {
            mesh.triangles.push_back({fresh[at(t[0])], fresh[at(t[1])], fresh[at(t[2])]});
        }
    }
    return mesh;
}

double mean_edge(const TriangleMesh& mesh) {
    double sum = 0.0;
    for (const auto& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            sum += (mesh.positions[at(t[k])] - mesh.positions[at(t[(k + 1) % 3])]).norm();
        }
    }
    return sum / (3.0 * static_cast<double>(mesh.triangles.size()));
}

int nearest_vertex(const TriangleMesh& mesh, const Eigen::Vector3d& place) {
    const auto nearest = std::min_element(
        mesh.positions.begin(), mesh.positions.end(), [&](const auto& a, const auto& b) {
            return (a - place).squaredNorm() < (b - place).squaredNorm();
        });
    return static_cast<int>(nearest - mesh.positions.begin());
}

// Root mean square distance from the vertices to the nearest different points of a foliation.
double distance_to(const Foliation& foliation, const TriangleMesh& mesh, const Loop& vertices) {
    std::vector<Eigen::Vector3d> points;
    for (const Singularity& singularity : foliation.singularities) {
        points.push_back(singularity.position);
    }
    double sum = 0.0;
    for (const ReachedPoint& reached : reached_points(mesh, vertices, points, {})) {
        sum += reached.distance * reached.distance;
    }
    return std::sqrt(sum / static_cast<double>(vertices.size()));
}

double distance_told(const Foliation& foliation) {
    double sum = 0.0;
    for (const ReachedPoint& reached : foliation.reached) {
        sum += reached.distance * reached.distance;
    }
    return std::sqrt(sum / static_cast<double>(foliation.reached.size()));
}

std::string refusal(const Mesh& mesh, const FoliationOptions& options) {
    try {
        compute_foliation(mesh, options);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::BadOption) << error.what();
        return std::string(error.code());
    }
    return "taken";
}

// Vertices round a cylinder, along its middle or at another part of its height.
Loop core_of(const Cylinder& cylinder, int count, double part = 0.5) {
    std::vector<Eigen::Vector2d> gf(cylinder.mesh.positions.size());
    for (std::size_t t = 0; t < cylinder.corner_gf.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            gf[at(cylinder.mesh.triangles[t][k])] = cylinder.corner_gf[t][k];
        }
    }
    Loop loop;
    for (int k = 0; k < count; ++k) {
        double least = std::numeric_limits<double>::infinity();
        int nearest = -1;
        for (std::size_t v = 0; v < gf.size(); ++v) {
            const double round = (gf[v].x() - cylinder.width * k / count) / cylinder.width;
            const double along = cylinder.width * (round - std::round(round));
            const double distance = std::hypot(along, gf[v].y() - part * cylinder.height);
            if (cylinder.source_vertex[v] >= 0 && distance < least) {
                least = distance;
                nearest = cylinder.source_vertex[v];
            }
        }
        if (std::find(loop.begin(), loop.end(), nearest) == loop.end()) {
            loop.push_back(nearest);
        }
    }
    return loop;
}

// The cylinders whose ends are both inside the surface.
std::vector<std::size_t> inner_cylinders(const Foliation& foliation) {
    std::vector<int> degree(at(foliation.graph.nodes), 0);
    for (const MetricGraph::Edge& edge : foliation.graph.edges) {
        ++degree[at(edge.from)];
        ++degree[at(edge.to)];
    }
    std::vector<std::size_t> inner;
    for (std::size_t e = 0; e < foliation.graph.edges.size(); ++e) {
        const MetricGraph::Edge& edge = foliation.graph.edges[e];
        if (degree[at(edge.from)] > 1 && degree[at(edge.to)] > 1) {
            inner.push_back(e);
        }
    }
    return inner;
}

// --- which points belong to which places -----------------------------------------------------

TEST(Assignment, IsTheCheapestOfAll) {
    std::mt19937 random(7);
    for (int round = 0; round < 50; ++round) {
        const auto rows = static_cast<Eigen::Index>(1 + random() % 4);
        const Eigen::Index columns = rows + static_cast<Eigen::Index>(random() % 3);
        Eigen::MatrixXd cost(rows, columns);
        for (Eigen::Index i = 0; i < cost.size(); ++i) {
            cost.data()[i] = static_cast<double>(random() % 1000);
        }
        std::vector<int> order(static_cast<std::size_t>(columns));
        std::iota(order.begin(), order.end(), 0);
        double least = std::numeric_limits<double>::infinity();
        do {
            double sum = 0.0;
            for (Eigen::Index r = 0; r < rows; ++r) {
                sum += cost(r, order[static_cast<std::size_t>(r)]);
            }
            least = std::min(least, sum);
        } while (std::next_permutation(order.begin(), order.end()));
        const std::vector<int> chosen = assign_columns(cost);
        double sum = 0.0;
        for (Eigen::Index r = 0; r < rows; ++r) {
            sum += cost(r, chosen[static_cast<std::size_t>(r)]);
        }
        EXPECT_EQ(sum, least);
        EXPECT_EQ(std::set<int>(chosen.begin(), chosen.end()).size(), chosen.size());
    }
}

// --- loops and their matrices ------------------------------------------------------------------

Holonomy round(const std::vector<Holonomy>& holonomies,
               const VertexRings& rings,
               const Loop& loop) {
    Holonomy all;
    for (std::size_t k = 0; k < loop.size(); ++k) {
        const int from = loop[k];
        const auto edge = at(find_edge(rings, from, loop[(k + 1) % loop.size()]));
        all =
            all * (rings.edges[edge].from == from ? holonomies[edge] : holonomies[edge].inverse());
    }
    return all;
}

class HolonomyOf : public ::testing::TestWithParam<const char*> {
protected:
    TriangleMesh mesh = surface(GetParam(), 2000);
    int count = static_cast<int>(mesh.positions.size());
    HalfEdges edges = build_half_edges(mesh.triangles, count);
    VertexRings rings = build_vertex_rings(edges, count);
    std::vector<Holonomy> holonomies = random_holonomies(edges, rings);
};

TEST_P(HolonomyOf, TrianglesIsTheIdentity) {
    for (const auto& t : mesh.triangles) {
        ASSERT_EQ(round(holonomies, rings, {t[0], t[1], t[2]}), Holonomy{});
    }
}

// Fewest edges; from `from`, included, to `to`, not included.
Loop edge_way(const VertexRings& rings, int from, int to) {
    Loop next(rings.begin.size() - 1, -1);
    Loop queue{to};
    next[at(to)] = to;
    for (std::size_t i = 0; next[at(from)] < 0; ++i) {
        for (int k = rings.begin[at(queue[i])]; k < rings.begin[at(queue[i]) + 1]; ++k) {
            const int w = rings.slots[at(k)].neighbour;
            if (next[at(w)] < 0) {
                next[at(w)] = queue[i];
                queue.push_back(w);
            }
        }
    }
    Loop way;
    for (int v = from; v != to; v = next[at(v)]) {
        way.push_back(v);
    }
    return way;
}

Loop closed_way(const VertexRings& rings, const Loop& corners) {
    Loop loop;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const Loop way = edge_way(rings, corners[k], corners[(k + 1) % corners.size()]);
        loop.insert(loop.end(), way.begin(), way.end());
    }
    return loop;
}

TEST_P(HolonomyOf, LoopsHasATraceForEachCylinderWhereverTheyRun) {
    const Foliation foliation = compute_foliation(
        to_mesh(mesh), {.mode = FoliationMode::Pants, .puncture = PunctureChoice::None});
    std::set<LoopTrace> traces{trace_of({})};
    for (const Cylinder& cylinder : foliation.cylinders) {
        std::set<LoopTrace> of_cylinder;
        for (const double part : {0.4, 0.5, 0.6}) {
            Loop corners = core_of(cylinder, 24, part);
            if (part > 0.5) {
                std::reverse(corners.begin(), corners.end());
            }
            of_cylinder.insert(trace_of(round(holonomies, rings, closed_way(rings, corners))));
        }
        EXPECT_EQ(of_cylinder.size(), 1U);
        EXPECT_TRUE(traces.insert(*of_cylinder.begin()).second) << "two cylinders go the same way";
    }
}

INSTANTIATE_TEST_SUITE_P(Surfaces, HolonomyOf, ::testing::Values("eight", "double-torus", "holes"));

// --- near places --------------------------------------------------------------------------------

class NearPlaces : public ::testing::TestWithParam<const char*> {
protected:
    TriangleMesh triangles = surface(GetParam(), 2000);
    Mesh mesh = to_mesh(triangles);
    FoliationOptions options{.mode = FoliationMode::Pants, .puncture = PunctureChoice::None};
    Foliation before = compute_foliation(mesh, options);
    double edge = mean_edge(triangles);
};

TEST_P(NearPlaces, PointsComeNearerThanWithoutAsking) {
    std::mt19937 random(3);
    double without = 0.0;
    double with = 0.0;
    for (int k = 0; k < 3; ++k) {
        options.near = {static_cast<int>(random() % triangles.positions.size())};
        const Foliation after = compute_foliation(mesh, options);
        ASSERT_EQ(after.reached.size(), 1U);
        EXPECT_EQ(after.reached[0].vertex, options.near[0]);
        const double old = distance_to(before, triangles, options.near);
        EXPECT_LE(after.reached[0].distance, old + edge) << "vertex " << options.near[0];
        EXPECT_NEAR(after.reached[0].distance, distance_to(after, triangles, options.near),
                    0.2 * edge);
        without += old;
        with += after.reached[0].distance;
    }
    EXPECT_LT(with, 0.8 * without);
}

TEST_P(NearPlaces, PointsThatAreThereStay) {
    options.near = {nearest_vertex(triangles, before.singularities.back().position)};
    EXPECT_LE(distance_told(compute_foliation(mesh, options)), edge);
}

TEST_P(NearPlaces, DifferentPointsServeDifferentPlaces) {
    options.near = {nearest_vertex(triangles, before.singularities[0].position),
                    static_cast<int>(triangles.positions.size() / 2)};
    const Foliation after = compute_foliation(mesh, options);
    ASSERT_EQ(after.reached.size(), 2U);
    EXPECT_NE(after.reached[0].singularity, after.reached[1].singularity);
    EXPECT_LE(distance_told(after), distance_to(before, triangles, options.near) + edge);
}

INSTANTIATE_TEST_SUITE_P(Surfaces, NearPlaces, ::testing::Values("eight", "holes"));

TEST(NearPlace, LeavesGivenWeightsAlone) {
    const Mesh mesh = to_mesh(make_sample("eight", 2000));
    FoliationOptions options;
    options.weights = {1.0, 0.7, 0.4};
    options.near = {100};
    const Foliation foliation = compute_foliation(mesh, options);
    ASSERT_EQ(foliation.reached.size(), 1U);
    for (std::size_t e = 0; e < 3; ++e) {
        EXPECT_EQ(foliation.graph.edges[e].weight, (*options.weights)[e]);
    }
}

TEST(NearPlace, IsTheSameOnAnyNumberOfThreads) {
    const Mesh mesh = to_mesh(make_sample("eight", 2000));
    FoliationOptions options;
    options.near = {42};
    Context four;
    four.threads = 4;
    const Foliation a = compute_foliation(mesh, options);
    const Foliation b = compute_foliation(mesh, options, four);
    EXPECT_EQ(a.reached[0].distance, b.reached[0].distance);
    EXPECT_EQ(a.energy, b.energy);
}

TEST(NearPlace, ChoosesTheLoopsOfAOneForm) {
    const TriangleMesh triangles = surface("holes", 3000);
    const Mesh mesh = to_mesh(triangles);
    FoliationOptions options{.mode = FoliationMode::OneForm, .puncture = PunctureChoice::None};
    const Foliation before = compute_foliation(mesh, options);
    std::mt19937 random(5);
    double gain = 0.0;
    for (int k = 0; k < 4; ++k) {
        options.near = {static_cast<int>(random() % triangles.positions.size())};
        const Foliation after = compute_foliation(mesh, options);
        const double old = distance_to(before, triangles, options.near);
        EXPECT_LE(distance_told(after), old + 2.0 * mean_edge(triangles));
        gain += old - distance_told(after);
    }
    EXPECT_GT(gain, 0.0);
}

TEST(NearPlace, MovesAPoleOfASphereThere) {
    const Mesh mesh = to_mesh(make_sample("sphere", 2000));
    FoliationOptions options{.mode = FoliationMode::SpherePolar};
    options.near = {123};
    const Foliation foliation = compute_foliation(mesh, options);
    ASSERT_EQ(foliation.punctures.size(), 2U);
    EXPECT_EQ(foliation.punctures[0].vertex, 123);
    ASSERT_EQ(foliation.reached.size(), 1U);
    EXPECT_EQ(foliation.reached[0].singularity, -1);  // It is cut out.
    EXPECT_EQ(foliation.reached[0].distance, 0.0);
}

TEST(NearPlace, IsRefusedWhereThereIsNoSingularPoint) {
    FoliationOptions options;
    options.near = {5};
    for (const char* name : {"torus", "square", "cylinder"}) {
        EXPECT_EQ(refusal(to_mesh(make_sample(name, 2000)), options), "no-singular-points") << name;
    }
}

TEST(NearPlace, IsRefusedForMorePlacesThanPoints) {
    FoliationOptions options;
    options.near = {5, 6, 7, 8, 9};
    EXPECT_EQ(refusal(to_mesh(make_sample("eight", 2000)), options), "too-many-near");
    EXPECT_EQ(refusal(to_mesh(make_sample("sphere", 2000)), options), "too-many-near");
}

// --- forbidden ways
// -------------------------------------------------------------------------------

class Forbidding : public ::testing::Test {
protected:
    // As traces tell.
    bool is_same_way(const Loop& a, const Loop& b) const {
        return trace_of(round(holonomies, rings, closed_way(rings, a))) ==
               trace_of(round(holonomies, rings, closed_way(rings, b)));
    }

    TriangleMesh triangles = make_sample("eight", 2000);
    HalfEdges edges =
        build_half_edges(triangles.triangles, static_cast<int>(triangles.positions.size()));
    VertexRings rings = build_vertex_rings(edges, static_cast<int>(triangles.positions.size()));
    std::vector<Holonomy> holonomies = random_holonomies(edges, rings);
    Mesh mesh = to_mesh(triangles);
    FoliationOptions options;
    Foliation before = compute_foliation(mesh, options);
};

TEST_F(Forbidding, ACylinderGivesAnotherDecomposition) {
    const std::size_t e = inner_cylinders(before).front();
    options.forbidden_loops = {core_of(before.cylinders[e], 12)};
    const Foliation after = compute_foliation(mesh, options);
    EXPECT_EQ(after.cylinders.size(), 3U);
    for (const Cylinder& cylinder : after.cylinders) {
        EXPECT_FALSE(is_same_way(core_of(cylinder, 16), options.forbidden_loops[0]));
    }
    // While without asking there is one that goes this way.
    EXPECT_TRUE(is_same_way(core_of(before.cylinders[e], 16), options.forbidden_loops[0]));
}

TEST_F(Forbidding, AWayThatNoCylinderGoesChangesNothing) {
    FoliationOptions others;
    others.pants = PantsSource::TunnelLoops;
    const Foliation tunnel = compute_foliation(mesh, others);
    std::set<std::string> outcomes;
    for (const std::size_t e : inner_cylinders(tunnel)) {
        options.forbidden_loops = {core_of(tunnel.cylinders[e], 12)};
        outcomes.insert(compute_foliation(mesh, options).energy == before.energy ? "same"
                                                                                 : "other");
    }
    EXPECT_EQ(outcomes.count("same"), 1U);
}

TEST_F(Forbidding, AllWaysIsRefused) {
    // Each new decomposition is forbidden in its turn, until none is left.
    std::string outcome = "taken";
    for (int round = 0; round < 8 && outcome == "taken"; ++round) {
        try {
            const Foliation foliation = compute_foliation(mesh, options);
            for (const std::size_t e : inner_cylinders(foliation)) {
                options.forbidden_loops.push_back(core_of(foliation.cylinders[e], 12));
            }
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::BadOption);
            outcome = std::string(error.code());
        }
    }
    EXPECT_EQ(outcome, "all-forbidden");
}

TEST_F(Forbidding, WhatBoundsADiskIsRefused) {
    const auto& t = triangles.triangles.front();
    options.forbidden_loops = {{t[0], t[1], t[2]}};
    EXPECT_EQ(refusal(mesh, options), "loop-not-essential");
}

TEST_F(Forbidding, LoopsThatAreToBeKeptIsRefused) {
    const std::size_t e = inner_cylinders(before).front();
    options.pants = PantsSource::User;
    options.loops = {core_of(before.cylinders[e], 12)};
    options.forbidden_loops = {core_of(before.cylinders[e], 9)};
    EXPECT_EQ(refusal(mesh, options), "loop-kept");
}

TEST(ForbiddenWay, RoundABoundaryIsRefused) {
    const Mesh mesh = to_mesh(surface("holes", 2000));
    const Foliation foliation =
        compute_foliation(mesh, {.mode = FoliationMode::Pants, .puncture = PunctureChoice::None});
    std::vector<std::size_t> inner = inner_cylinders(foliation);
    FoliationOptions options{.mode = FoliationMode::Pants, .puncture = PunctureChoice::None};
    for (std::size_t e = 0; e < foliation.cylinders.size(); ++e) {
        if (std::find(inner.begin(), inner.end(), e) == inner.end()) {
            options.forbidden_loops = {core_of(foliation.cylinders[e], 12)};
            EXPECT_EQ(refusal(mesh, options), "loop-at-boundary") << "cylinder " << e;
            return;
        }
    }
    FAIL() << "no cylinder at a boundary";
}

TEST(ForbiddenWay, HasNoMeaningWithoutPants) {
    FoliationOptions options;
    options.forbidden_loops = {{1, 2, 3}};
    EXPECT_EQ(refusal(to_mesh(make_sample("torus", 2000)), options), "nothing-to-forbid");
}

// --- loops of the user's own
// ----------------------------------------------------------------------

// One loop of three is given; the others are found.
TEST(SomeLoops, AreKeptAndTheOthersAdded) {
    const Mesh mesh = to_mesh(make_sample("eight", 2000));
    FoliationOptions options;
    options.pants = PantsSource::TunnelLoops;
    const Foliation tunnel = compute_foliation(mesh, options);
    FoliationOptions given;
    given.pants = PantsSource::User;
    given.loops = {core_of(tunnel.cylinders[inner_cylinders(tunnel).back()], 12)};
    const Foliation foliation = compute_foliation(mesh, given);
    ASSERT_EQ(foliation.cylinders.size(), 3U);
    int kept = 0;
    for (const Cylinder& cylinder : foliation.cylinders) {
        given.forbidden_loops = {core_of(cylinder, 12)};
        kept += refusal(mesh, given) == "loop-kept" ? 1 : 0;
    }
    EXPECT_EQ(kept, 1);
}

}  // namespace
}  // namespace leafcutter::geometry
