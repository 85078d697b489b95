#include <random>

#include <gtest/gtest.h>

#include "geometry/laplacian.h"
#include "geometry/loops/tree_cotree.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;
using testing::jitter;
using testing::make_grid;
using testing::make_prism;
using testing::make_square;
using testing::make_torus;

std::vector<WeightedEdge> edges_of(const TriangleMesh& mesh) {
    return cotangent_edges(intrinsic_delaunay(
        mesh, build_half_edges(mesh.triangles, static_cast<int>(mesh.positions.size()))));
}

// Two by two unit cells of two right triangles each: 8 triangles. By hand: axis edges weigh 1
// inside and 1/2 on the border, diagonals 0.
TEST(Laplacian, GivesTheEnergyOfEightTrianglesWorkedOutByHand) {
    const TriangleMesh mesh = make_square(2);
    const std::vector<WeightedEdge> edges = edges_of(mesh);
    ASSERT_EQ(mesh.triangles.size(), 8U);
    Eigen::VectorXd hat = Eigen::VectorXd::Zero(9);
    hat[4] = 1.0;  // The middle: four edges of weight 1.
    EXPECT_NEAR(dirichlet_energy(edges, hat), 2.0, 1e-12);
    Eigen::VectorXd linear(9);
    for (int v = 0; v < 9; ++v) {
        linear[v] = 3.0 * mesh.positions[at(v)].x() - 4.0 * mesh.positions[at(v)].y();
    }
    // Half of |(3, -4)|^2 over area 1.
    EXPECT_NEAR(dirichlet_energy(edges, linear), 12.5, 1e-12);
}

TEST(Laplacian, ReproducesLinearFunctionsOnAnyPlanarMesh) {
    std::minstd_rand random(5);
    TriangleMesh plane = make_square(15);
    jitter(plane, 0.02, random);
    std::vector<char> held(plane.positions.size(), 0);
    Eigen::VectorXd values(static_cast<Eigen::Index>(held.size()));
    for (std::size_t v = 0; v < held.size(); ++v) {
        plane.positions[v].z() = 0.0;
        const auto column = v % 16;
        const auto row = v / 16;
        held[v] = column == 0 || column == 15 || row == 0 || row == 15 ? 1 : 0;
        values[static_cast<Eigen::Index>(v)] =
            plane.positions[v].x() + 2.0 * plane.positions[v].y();
    }
    const std::vector<WeightedEdge> edges = edges_of(plane);
    Eigen::VectorXd start = values;
    for (std::size_t v = 0; v < held.size(); ++v) {
        start[static_cast<Eigen::Index>(v)] *= held[v];
    }
    EXPECT_LT((HarmonicSolver(edges, held).solve(start) - values).norm(), 1e-12);
}

// The flux of a harmonic function is the same through every level (requirements P2).
TEST(Laplacian, HarmonicFunctionHasTheSameFluxThroughEveryLeaf) {
    std::minstd_rand random(11);
    TriangleMesh tube = make_prism(24, 30, 1.0, 3.0);
    jitter(tube, 0.03, random);
    const std::vector<WeightedEdge> edges = edges_of(tube);
    std::vector<char> held(tube.positions.size(), 0);
    Eigen::VectorXd f = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size()));
    for (std::size_t k = 0; k < 24; ++k) {
        held[k] = 1;
        held[held.size() - 1 - k] = 1;
        f[static_cast<Eigen::Index>(held.size() - 1 - k)] = 1.0;
    }
    f = HarmonicSolver(edges, held).solve(f);
    const double whole = 2.0 * dirichlet_energy(edges, f);  // Flux times height 1.
    for (double level = 0.05; level < 1.0; level += 0.1) {
        double flux = 0.0;
        for (const WeightedEdge& edge : edges) {
            const double a = f[edge.from];
            const double b = f[edge.to];
            if ((a < level) != (b < level)) {
                flux += edge.weight * std::abs(b - a);
            }
        }
        EXPECT_NEAR(flux, whole, 1e-8 * whole) << "at level " << level;
    }
}

TEST(Laplacian, MultivaluedFunctionRisesEvenlyRoundAPrism) {
    const TriangleMesh prism = make_prism(12, 4, 1.0, 1.0);
    const HalfEdges half_edges =
        build_half_edges(prism.triangles, static_cast<int>(prism.positions.size()));
    std::vector<int> loop(prism.positions.size(), -1);
    for (std::size_t k = 0; k < 12; ++k) {
        loop[k] = 0;
        loop[loop.size() - 1 - k] = 1;
    }
    const Cochain arc = arc_cochain(half_edges, loop, 0, 1);
    std::vector<Jump> jump(arc.size());
    for (std::size_t h = 0; h < arc.size(); ++h) {
        jump[h] = {arc[h], 0};
    }
    const IntrinsicTriangulation mesh = intrinsic_delaunay(prism, half_edges, jump);
    const std::vector<WeightedEdge> edges = cotangent_edges(mesh);
    std::vector<double> edge_jump;
    for (const WeightedEdge& edge : edges) {
        edge_jump.push_back(mesh.jump[at(edge.half_edge)][0]);
    }
    std::vector<char> held(prism.positions.size(), 0);
    held[0] = 1;
    const Eigen::VectorXd g =
        HarmonicSolver(edges, held)
            .solve(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size())), edge_jump);
    const double perimeter = 12.0 * 2.0 * std::sin(std::numbers::pi / 12.0);
    EXPECT_NEAR(2.0 * dirichlet_energy(edges, g, edge_jump), 1.0 / perimeter, 1e-12);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const int steps = (edges[e].to % 12 - edges[e].from % 12 + 12) % 12;  // 0, 1 or 11.
        const double rise = std::abs(g[edges[e].to] - g[edges[e].from] + edge_jump[e]);
        EXPECT_NEAR(rise, steps == 0 ? 0.0 : 1.0 / 12.0, 1e-12);
    }
}

TEST(Laplacian, PositiveEdgesArePositiveOnFlatTriangles) {
    TriangleMesh square = make_square(6);
    square.positions[8] = square.positions[9];
    for (const WeightedEdge& edge : positive_edges(
             square,
             build_half_edges(square.triangles, static_cast<int>(square.positions.size())))) {
        EXPECT_GT(edge.weight, 0.0);
        EXPECT_LT(edge.weight, 100.0);
    }
}

TEST(TreeCotree, FindsTwoIndependentClosedCochainsOfATorus) {
    const TriangleMesh torus = make_torus(8, 14, 0.3);
    const HalfEdges edges =
        build_half_edges(torus.triangles, static_cast<int>(torus.positions.size()));
    const auto basis = cohomology_basis(edges, static_cast<int>(torus.positions.size()));
    ASSERT_EQ(basis.size(), 2U);
    // Periods round the tube (vertices 0..7) and along it (0, 8, 16, ..).
    Eigen::Matrix2i periods = Eigen::Matrix2i::Zero();
    for (int h = 0; h < edges.size(); ++h) {
        const int a = edges.from_of(h);
        const int b = edges.to_of(h);
        for (int k = 0; k < 2; ++k) {
            if (a < 8 && b == (a + 1) % 8) {
                periods(k, 0) += basis[at(k)][at(h)];
            }
            if (a % 8 == 0 && b == (a + 8) % (8 * 14)) {
                periods(k, 1) += basis[at(k)][at(h)];
            }
            EXPECT_EQ(basis[at(k)][at(h)], -basis[at(k)][at(edges.twin_of(h))]);
        }
    }
    EXPECT_EQ(std::abs(periods(0, 0) * periods(1, 1) - periods(0, 1) * periods(1, 0)), 1);
}

}  // namespace
}  // namespace leafcutter::geometry
