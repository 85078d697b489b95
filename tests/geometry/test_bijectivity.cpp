// The ladder that makes charts one-to-one, and its guarantee on nasty input.

#include <cmath>
#include <cstdint>
#include <random>

#include <gtest/gtest.h>

#include "geometry/foliation.h"
#include "geometry/harmonic/bijectivity.h"
#include "tests/geometry/chart_checks.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::add_needles;
using testing::at;
using testing::is_sound;
using testing::jitter;
using testing::make_finger;
using testing::make_grid;
using testing::make_prism;
using testing::make_square;
using testing::to_mesh;

constexpr int kCells = 8;

// The identity of the unit square, with its four rails.
ChartMap identity_map() {
    const TriangleMesh square = make_square(kCells);
    ChartMap map =
        start_chart(start_surface(square, std::vector<std::uint8_t>(square.positions.size(), 0)));
    map.width = 1.0;
    map.height = 1.0;
    for (std::size_t v = 0; v < map.gf.size(); ++v) {
        map.gf[v] = square.positions[v].head<2>();
    }
    return map;
}

std::vector<Rail> square_rails() {
    std::vector<Rail> rails(4);
    const int n = kCells + 1;
    for (int i = 0; i < n; ++i) {
        rails[0].vertices.push_back(i);
        rails[1].vertices.push_back(i * n + kCells);
        rails[2].vertices.push_back(kCells * n + i);
        rails[3].vertices.push_back(i * n);
    }
    rails[1].axis = 1;
    rails[3].axis = 1;
    return rails;
}

TEST(Bijectivity, LeavesAGoodMapAlone) {
    ChartMap map = identity_map();
    const std::vector<Eigen::Vector2d> before = map.gf;
    const FlipReport report = make_bijective(map, square_rails(), {});
    EXPECT_EQ(report.flipped_as_solved, 0);
    EXPECT_EQ(map.gf, before);
}

TEST(Bijectivity, MendsOneFlipWithoutTouchingTheRest) {
    ChartMap map = identity_map();
    map.gf[at(4 * (kCells + 1) + 4)] += Eigen::Vector2d(0.2, 0.0);
    const FlipReport report = make_bijective(map, square_rails(), {});
    EXPECT_GT(report.flipped_as_solved, 0);
    EXPECT_FALSE(report.whole_chart);
    EXPECT_TRUE(bad_triangles(map).empty());
    for (const std::size_t far : {std::size_t{10}, std::size_t{16}, std::size_t{70}}) {
        EXPECT_EQ(map.gf[far], identity_map().gf[far]);
    }
}

TEST(Bijectivity, MakesRailsMonotone) {
    ChartMap map = identity_map();
    std::swap(map.gf[3], map.gf[4]);  // On the bottom side.
    make_bijective(map, square_rails(), {});
    EXPECT_TRUE(bad_triangles(map).empty());
    for (std::size_t i = 0; i < kCells; ++i) {
        EXPECT_LT(map.gf[i].x(), map.gf[i + 1].x());
        EXPECT_EQ(map.gf[i].y(), 0.0);
    }
    EXPECT_EQ(map.gf[0].x(), 0.0);
    EXPECT_EQ(map.gf[kCells].x(), 1.0);
}

TEST(Bijectivity, UnscramblesAnyInterior) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        ChartMap map = identity_map();
        std::minstd_rand random(seed);
        std::uniform_real_distribution<double> anywhere(-2.0, 3.0);
        for (int v = 0; v < static_cast<int>(map.gf.size()); ++v) {
            const int column = v % (kCells + 1);
            const int row = v / (kCells + 1);
            if (column > 0 && column < kCells && row > 0 && row < kCells) {
                map.gf[at(v)] = {anywhere(random), anywhere(random)};
            }
        }
        make_bijective(map, square_rails(), {});
        EXPECT_TRUE(bad_triangles(map).empty()) << "seed " << seed;
        EXPECT_NEAR(chart_area(map), 1.0, 1e-12);
    }
}

// Property: whatever a disk or an annulus looks like, every triangle of its chart is positive.
TEST(Bijectivity, HoldsOnRoughSheetsWithNeedles) {
    for (unsigned seed = 1; seed <= 40; ++seed) {
        std::minstd_rand random(seed);
        const bool ring = seed % 2 == 0;
        TriangleMesh mesh =
            make_grid({.across = 14,
                       .along = 11,
                       .closed_across = ring,
                       .position =
                           [=](double u, double v) {
                               const double a = 2.0 * std::numbers::pi * u;
                               return ring ? Eigen::Vector3d(std::cos(a), std::sin(a), 1.5 * v)
                                           : Eigen::Vector3d(
                                                 u, v, 0.3 * std::sin(5.0 * u) * std::cos(4.0 * v));
                           },
                       .random_diagonals = true,
                       .seed = seed});
        jitter(mesh, 0.005 * (seed % 10), random);
        add_needles(mesh, 10 * static_cast<int>(seed % 7), random);
        const Foliation foliation = compute_foliation(to_mesh(mesh));
        EXPECT_TRUE(is_sound(foliation.cylinders[0])) << "seed " << seed;
        EXPECT_TRUE(std::isfinite(foliation.energy));
    }
}

TEST(Bijectivity, HoldsOnFlatTriangles) {
    std::minstd_rand random(1);
    for (int round = 0; round < 10; ++round) {
        TriangleMesh mesh = make_square(10);
        for (int k = 0; k < 12; ++k) {
            // A vertex put onto a neighbour, or onto the line between two.
            const int v = 12 + static_cast<int>(random() % 90);
            mesh.positions[at(v)] =
                k % 2 == 0 ? mesh.positions[at(v + 1)]
                           : 0.5 * (mesh.positions[at(v + 1)] + mesh.positions[at(v - 1)]);
        }
        EXPECT_TRUE(is_sound(compute_foliation(to_mesh(mesh)).cylinders[0])) << "round " << round;
    }
}

TEST(Bijectivity, HoldsOnLongFingers) {
    FoliationOptions options;
    options.puncture = PunctureChoice::None;
    for (const double length : {0.5, 2.0, 4.0, 8.0, 20.0}) {
        const Foliation foliation = compute_foliation(to_mesh(make_finger(80, length)), options);
        EXPECT_TRUE(is_sound(foliation.cylinders[0])) << "length " << length;
        // From exp(-2 pi L / C) = exp(-80) on, numbers can't hold a conformal chart: the user is
        // told.
        if (length >= 8.0) {
            ASSERT_FALSE(foliation.warnings.empty());
            EXPECT_NE(foliation.warnings.back().find("limbs"), std::string::npos);
        }
    }
}

}  // namespace
}  // namespace leafcutter::geometry
