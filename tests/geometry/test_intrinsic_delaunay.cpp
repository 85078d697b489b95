#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/intrinsic_delaunay.h"
#include "geometry/laplacian.h"
#include "geometry/loops/tree_cotree.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::add_needles;
using testing::at;
using testing::jitter;
using testing::make_grid;
using testing::make_square;
using testing::make_torus;

IntrinsicTriangulation delaunay_of(const TriangleMesh& mesh, std::span<const Jump> jump = {}) {
    return intrinsic_delaunay(
        mesh, build_half_edges(mesh.triangles, static_cast<int>(mesh.positions.size())), jump);
}

double least_interior_weight(const IntrinsicTriangulation& mesh) {
    double least = 1.0;
    for (int h = 0; h < mesh.edges.size(); ++h) {
        if (mesh.edges.twin_of(h) >= 0) {
            const double sum =
                facing_cotangent(mesh, h) + facing_cotangent(mesh, mesh.edges.twin_of(h));
            least = std::min(least, sum / (1.0 + std::abs(facing_cotangent(mesh, h))));
        }
    }
    return least;
}

void expect_consistent(const IntrinsicTriangulation& mesh) {
    for (int h = 0; h < mesh.edges.size(); ++h) {
        const int twin = mesh.edges.twin_of(h);
        if (twin < 0) {
            continue;
        }
        ASSERT_EQ(mesh.edges.twin_of(twin), h);
        ASSERT_EQ(mesh.edges.from_of(twin), mesh.edges.to_of(h));
        ASSERT_EQ(mesh.length[at(twin)], mesh.length[at(h)]);
        ASSERT_EQ(mesh.jump[at(twin)][0], -mesh.jump[at(h)][0]);
        ASSERT_EQ(mesh.jump[at(twin)][1], -mesh.jump[at(h)][1]);
    }
}

TEST(IntrinsicDelaunay, LeavesADelaunayMeshAlone) {
    const TriangleMesh square = make_square(10);
    const IntrinsicTriangulation result = delaunay_of(square);
    EXPECT_EQ(result.flips, 0);
    EXPECT_EQ(result.added_length, 0.0);
    EXPECT_NEAR(result.length[0], 0.1, 1e-15);
}

TEST(IntrinsicDelaunay, FlipsTheLongDiagonalOfARhombus) {
    TriangleMesh rhombus;
    rhombus.positions = {{-2, 0, 0}, {0, -1, 0}, {2, 0, 0}, {0, 1, 0}};
    rhombus.triangles = {{0, 1, 2}, {0, 2, 3}};
    const IntrinsicTriangulation result = delaunay_of(rhombus);
    EXPECT_EQ(result.flips, 1);
    double shortest = 10.0;
    for (int h = 0; h < 6; ++h) {
        if (result.edges.twin_of(h) >= 0) {
            shortest = result.length[at(h)];
        }
    }
    EXPECT_NEAR(shortest, 2.0, 1e-14);
    expect_consistent(result);
}

TEST(IntrinsicDelaunay, KeepsDistancesOfAPlaneExactly) {
    std::minstd_rand random(7);
    TriangleMesh plane = make_square(12);
    for (Eigen::Vector3d& p : plane.positions) {
        p.x() = p.x() * 5.0 + 2.0 * p.y();  // Sheared, so that most diagonals are the wrong ones.
    }
    const IntrinsicTriangulation result = delaunay_of(plane);
    EXPECT_GT(result.flips, 50);
    for (int h = 0; h < result.edges.size(); ++h) {
        const double distance = (plane.positions[at(result.edges.from_of(h))] -
                                 plane.positions[at(result.edges.to_of(h))])
                                    .norm();
        EXPECT_NEAR(result.length[at(h)], distance, 1e-12);
    }
}

TEST(IntrinsicDelaunay, MakesEveryInteriorWeightNonNegative) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
        std::minstd_rand random(seed);
        TriangleMesh torus = make_torus(12, 30, 0.4);
        jitter(torus, 0.06, random);
        add_needles(torus, 100, random);
        const IntrinsicTriangulation result = delaunay_of(torus);
        EXPECT_GE(least_interior_weight(result), -1e-8) << "seed " << seed;
        expect_consistent(result);
    }
}

TEST(IntrinsicDelaunay, CarriesClosedCochainsThroughFlips) {
    std::minstd_rand random(3);
    TriangleMesh torus = make_torus(10, 24, 0.4);
    jitter(torus, 0.07, random);
    const HalfEdges edges =
        build_half_edges(torus.triangles, static_cast<int>(torus.positions.size()));
    const auto basis = cohomology_basis(edges, static_cast<int>(torus.positions.size()));
    ASSERT_EQ(basis.size(), 2U);
    std::vector<Jump> jump(basis[0].size());
    for (std::size_t h = 0; h < jump.size(); ++h) {
        jump[h] = {basis[0][h], basis[1][h]};
    }
    const IntrinsicTriangulation result = intrinsic_delaunay(torus, edges, jump);
    ASSERT_GT(result.flips, 10);
    expect_consistent(result);
    for (int h = 0; h < result.edges.size(); h += 3) {
        for (std::size_t k = 0; k < 2; ++k) {
            EXPECT_EQ(result.jump[at(h)][k] + result.jump[at(h + 1)][k] + result.jump[at(h + 2)][k],
                      0);
        }
    }
}

TEST(IntrinsicDelaunay, GivesFiniteWeightsOnFlatAndPointLikeTriangles) {
    TriangleMesh square = make_square(6);
    square.positions[8] = square.positions[9];                                   // A zero edge.
    square.positions[17] = 0.5 * (square.positions[16] + square.positions[18]);  // Collinear.
    square.positions[24] = square.positions[16];
    const IntrinsicTriangulation result = delaunay_of(square);
    EXPECT_GT(result.added_length, 0.0);
    for (const WeightedEdge& edge : cotangent_edges(result)) {
        EXPECT_TRUE(std::isfinite(edge.weight));
        EXPECT_LT(std::abs(edge.weight), 1e12);
    }
}

TEST(IntrinsicDelaunay, UndoesItsFlipsForACochain) {
    std::minstd_rand random(9);
    TriangleMesh torus = make_torus(12, 20, 0.4);
    jitter(torus, 0.05, random);
    add_needles(torus, 60, random);
    const HalfEdges edges =
        build_half_edges(torus.triangles, static_cast<int>(torus.positions.size()));
    const Cochain class_of = cohomology_basis(edges, static_cast<int>(torus.positions.size()))[0];
    std::vector<Jump> jump;
    for (const int value : class_of) {
        jump.push_back({value, 0});
    }
    const IntrinsicTriangulation result = intrinsic_delaunay(torus, edges, jump);
    EXPECT_GT(result.flips, 20);
    std::vector<double> values;
    for (int h = 0; h < result.edges.size(); ++h) {
        values.push_back(result.jump[at(h)][0] + 3.0 * result.edges.to_of(h) -
                         3.0 * result.edges.from_of(h));
    }
    values = undo_flips(result, std::move(values));
    for (int h = 0; h < edges.size(); ++h) {
        ASSERT_EQ(values[at(h)], class_of[at(h)] + 3.0 * edges.to_of(h) - 3.0 * edges.from_of(h));
    }
}

}  // namespace
}  // namespace leafcutter::geometry
