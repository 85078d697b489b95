#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/cases/corners.h"
#include "geometry/foliation.h"
#include "tests/geometry/chart_checks.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;
using testing::is_sound;
using testing::make_grid;
using testing::make_square;
using testing::to_mesh;
using testing::vertex_gf;

// The square's disk rounded: an ellipse or a circle without a boundary corner.
TriangleMesh make_ellipse(int cells, double aspect) {
    return make_grid({.across = cells, .along = cells, .position = [=](double u, double v) {
                          const double x = 2.0 * u - 1.0;
                          const double y = 2.0 * v - 1.0;
                          return Eigen::Vector3d(aspect * x * std::sqrt(1.0 - y * y / 2.0),
                                                 y * std::sqrt(1.0 - x * x / 2.0), 0.0);
                      }});
}

TEST(DiskFoliation, MapsASquareOntoItselfExactly) {
    const TriangleMesh square = make_square(20);
    const Foliation foliation = compute_foliation(to_mesh(square));
    const Cylinder& chart = foliation.cylinders[0];
    EXPECT_TRUE(is_sound(chart));
    EXPECT_NEAR(chart.width, 1.0, 1e-12);
    EXPECT_NEAR(chart.conformal_gap, 0.0, 1e-12);
    ASSERT_TRUE(foliation.corners);
    // A square up to the choice of the bottom side: distances are kept exactly.
    const auto gf = vertex_gf(chart);
    for (std::size_t t = 0; t < chart.mesh.triangles.size(); ++t) {
        const auto& triangle = chart.mesh.triangles[t];
        for (std::size_t k = 0; k < 3; ++k) {
            const auto a = at(triangle[k]);
            const auto b = at(triangle[(k + 1) % 3]);
            const double wanted = (chart.mesh.positions[a] - chart.mesh.positions[b]).norm();
            EXPECT_NEAR((gf[a] - gf[b]).norm(), wanted, 1e-11);
        }
    }
}

TEST(DiskFoliation, RisesAlongTheLongerPairOfSides) {
    for (const double length : {0.25, 4.0}) {
        const TriangleMesh strip =
            make_grid({.across = 16, .along = 16, .position = [=](double u, double v) {
                           return Eigen::Vector3d(length * u, v, 0.0);
                       }});
        const Foliation foliation = compute_foliation(to_mesh(strip));
        EXPECT_NEAR(foliation.cylinders[0].height, 1.0, 0.0);
        EXPECT_NEAR(foliation.cylinders[0].width, 0.25, 1e-12);
    }
}

TEST(DiskFoliation, FindsTheCornersThatTurn) {
    const TriangleMesh square = make_square(20);  // 21 vertices a side.
    const auto corners = compute_foliation(to_mesh(square)).corners;
    ASSERT_TRUE(corners);
    std::array<int, 4> sorted = *corners;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, (std::array<int, 4>{0, 20, 420, 440}));
}

TEST(DiskFoliation, TakesEqualArcsOnASmoothBoundary) {
    std::vector<int> loop;
    TriangleMesh fan;
    const int n = 64;
    fan.positions.emplace_back(0, 0, 0);
    for (int i = 0; i < n; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / n;
        fan.positions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
        fan.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
        loop.push_back(1 + i);
    }
    const LoopCorners corners = choose_corners(fan, loop);
    for (std::size_t k = 1; k < 4; ++k) {
        EXPECT_EQ(corners[k] - corners[k - 1], n / 4);
    }
}

TEST(DiskFoliation, TakesGivenCornersInAnyOrder) {
    const TriangleMesh square = make_square(8);
    FoliationOptions options;
    options.corners = {4, 76, 36, 44};  // The middles of the sides, crosswise.
    const Foliation a = compute_foliation(to_mesh(square), options);
    options.corners = {44, 4, 36, 76};
    const Foliation b = compute_foliation(to_mesh(square), options);
    EXPECT_EQ(a.corners, b.corners);
    EXPECT_EQ(a.cylinders[0].width, b.cylinders[0].width);
    EXPECT_TRUE(is_sound(a.cylinders[0]));
    // By symmetry the modulus is 1 whatever the mesh.
    EXPECT_NEAR(a.cylinders[0].width, 1.0, 0.02);
}

TEST(DiskFoliation, CornersLieAtTheRectanglesCornersCounterClockwise) {
    const TriangleMesh mesh = make_ellipse(24, 2.0);
    const Foliation foliation = compute_foliation(to_mesh(mesh));
    const Cylinder& chart = foliation.cylinders[0];
    const auto gf = vertex_gf(chart);
    ASSERT_TRUE(foliation.corners);
    const std::array<Eigen::Vector2d, 4> wanted{
        Eigen::Vector2d{0, 0}, Eigen::Vector2d{chart.width, 0},
        Eigen::Vector2d{chart.width, chart.height}, Eigen::Vector2d{0, chart.height}};
    for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_LT((gf[at((*foliation.corners)[k])] - wanted[k]).norm(), 1e-14);
    }
}

// A quarter of a circular ring with its four natural corners: modulus ln(R/r) : angle.
TEST(DiskFoliation, ModulusOfARingSectorConvergesToTheClosedForm) {
    const double exact = (std::numbers::pi / 2.0) / std::log(4.0);
    std::vector<double> errors;
    for (const int cells : {8, 16, 32}) {
        const TriangleMesh sector = make_grid(
            {.across = cells, .along = cells, .position = [](double u, double v) {
                 const double radius = 4.0 - 3.0 * v;
                 const double angle = 0.5 * std::numbers::pi * u;
                 return Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), 0.0);
             }});
        FoliationOptions options;
        options.refinement = Refinement::Off;
        const int n = cells + 1;
        options.corners = {0, cells, n * n - 1, n * n - n};
        const Cylinder chart = compute_foliation(to_mesh(sector), options).cylinders[0];
        EXPECT_TRUE(is_sound(chart));
        const double modulus = chart.width / chart.height;
        errors.push_back(std::abs(std::max(modulus, 1.0 / modulus) - exact) / exact);
    }
    EXPECT_LT(errors[2], 1e-3);
    EXPECT_GT(errors[0] / errors[1], 3.0);
    EXPECT_GT(errors[1] / errors[2], 3.0);
}

TEST(DiskFoliation, SplitsChordsAndKeepsTheGivenVertices) {
    // Two triangles have two border edges each; with these corners both lie within one side.
    const TriangleMesh square = make_square(6);
    FoliationOptions options;
    options.corners = {3, 4, 5, 20};
    const Cylinder chart = compute_foliation(to_mesh(square), options).cylinders[0];
    EXPECT_TRUE(is_sound(chart));
    EXPECT_GT(chart.mesh.positions.size(), square.positions.size());
    for (std::size_t v = 0; v < chart.mesh.positions.size(); ++v) {
        if (v < square.positions.size()) {
            EXPECT_EQ(chart.source_vertex[v], static_cast<int>(v));
            EXPECT_EQ(chart.mesh.positions[v], square.positions[v]);
        } else {
            EXPECT_EQ(chart.source_vertex[v], -1);
        }
    }
}

// A circle with four corners: at each, the map goes as the square root of the distance.
TEST(DiskFoliation, WarnsWhereTheMeshIsTooCoarse) {
    FoliationOptions options;
    options.refinement = Refinement::Off;
    const Foliation foliation = compute_foliation(to_mesh(make_ellipse(3, 1.0)), options);
    ASSERT_GT(foliation.cylinders[0].conformal_gap, 0.05);
    ASSERT_EQ(foliation.warnings.size(), 1U);
    EXPECT_NE(foliation.warnings[0].find("coarse"), std::string::npos);
}

TEST(DiskFoliation, RefinesFlatUntilTheModulusIsCertain) {
    const TriangleMesh coarse = make_ellipse(6, 1.0);
    const Foliation foliation = compute_foliation(to_mesh(coarse));
    const Cylinder& chart = foliation.cylinders[0];
    EXPECT_TRUE(is_sound(chart));
    EXPECT_TRUE(foliation.warnings.empty());
    EXPECT_LT(chart.conformal_gap, 0.006);
    EXPECT_NEAR(chart.width, 1.0, 1e-3);
    const auto area_of = [](const TriangleMesh& mesh) {
        double sum = 0.0;
        for (const auto& t : mesh.triangles) {
            sum += 0.5 * (mesh.positions[at(t[1])] - mesh.positions[at(t[0])])
                             .cross(mesh.positions[at(t[2])] - mesh.positions[at(t[0])])
                             .norm();
        }
        return sum;
    };
    EXPECT_GT(chart.mesh.triangles.size(), coarse.triangles.size());
    EXPECT_NEAR(area_of(chart.mesh), area_of(coarse), 1e-12);
    // Boundary midpoints stay on their sides.
    for (const Eigen::Vector2d& gf : vertex_gf(chart)) {
        EXPECT_GE(gf.x(), 0.0);
        EXPECT_LE(gf.x(), chart.width);
        EXPECT_GE(gf.y(), 0.0);
        EXPECT_LE(gf.y(), chart.height);
    }
}

}  // namespace
}  // namespace leafcutter::geometry
