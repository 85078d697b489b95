#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>

#include "geometry/closest_point.h"
#include "geometry/leaves.h"
#include "tests/geometry/charts.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Vector3d;

struct Sampled {
    std::vector<Leaf> weft;  // Of F.
    std::vector<Leaf> warp;  // Of F*.
};

Sampled sampled(const Foliation& foliation, int rows, int cols, int stride = 1) {
    GridOptions options;
    options.all = {.rows = rows, .cols = cols};
    options.parity = Parity::Any;
    Sampled result;
    for (Leaf& leaf : sample_leaves(foliation, build_quad_mesh(foliation, options), stride)) {
        (leaf.of_conjugate ? result.warp : result.weft).push_back(std::move(leaf));
    }
    return result;
}

double length(const Leaf& leaf) {
    double sum = 0.0;
    for (std::size_t i = 1; i < leaf.points.size(); ++i) {
        sum += (leaf.points[i] - leaf.points[i - 1]).norm();
    }
    return leaf.closed ? sum + (leaf.points.back() - leaf.points.front()).norm() : sum;
}

TEST(Leaves, OfARectangleAreItsGridLines) {
    // Levels 5 apart pass through vertices of the 20 x 20 mesh; the boundary's own are there too.
    const Sampled leaves = sampled(testing::flat_rectangle(40.0, 20.0), 4, 8);
    ASSERT_EQ(leaves.weft.size(), 5U);
    ASSERT_EQ(leaves.warp.size(), 9U);
    for (std::size_t i = 0; i < leaves.weft.size(); ++i) {
        EXPECT_FALSE(leaves.weft[i].closed);
        EXPECT_NEAR(leaves.weft[i].level, 5.0 * static_cast<double>(i), 1e-12);
        EXPECT_NEAR(length(leaves.weft[i]), 40.0, 1e-9);
        for (const Vector3d& point : leaves.weft[i].points) {
            EXPECT_NEAR(point.y(), 5.0 * static_cast<double>(i), 1e-12);
        }
    }
    for (const Leaf& leaf : leaves.warp) {
        EXPECT_NEAR(length(leaf), 20.0, 1e-9);
        for (const Vector3d& point : leaf.points) {
            EXPECT_NEAR(point.x(), leaf.level, 1e-12);
        }
    }
}

TEST(Leaves, CloseAroundACylinder) {
    const Sampled leaves = sampled(testing::round_cylinder(10.0, 20.0, 97, 13), 5, 7);
    ASSERT_EQ(leaves.weft.size(), 6U);
    ASSERT_EQ(leaves.warp.size(), 7U);
    for (const Leaf& ring : leaves.weft) {
        EXPECT_TRUE(ring.closed);
        EXPECT_NEAR(length(ring), 20.0 * std::numbers::pi, 0.02);
        for (const Vector3d& point : ring.points) {
            EXPECT_NEAR(point.z(), ring.level, 1e-12);
        }
    }
    for (const Leaf& line : leaves.warp) {
        EXPECT_FALSE(line.closed);
        EXPECT_NEAR(length(line), 20.0, 1e-2);
    }
}

TEST(Leaves, OfAnAlignedTorusAllClose) {
    const Sampled leaves = sampled(testing::round_torus(100.0, 25.0), 16, 8);
    ASSERT_EQ(leaves.weft.size(), 16U);
    ASSERT_EQ(leaves.warp.size(), 8U);
    for (const Leaf& ring : leaves.weft) {
        EXPECT_TRUE(ring.closed);
        EXPECT_NEAR(length(ring), 50.0 * std::numbers::pi, 1.0);
    }
    for (const Leaf& around : leaves.warp) {
        EXPECT_TRUE(around.closed);
        EXPECT_GT(length(around), 149.0 * std::numbers::pi);
    }
}

TEST(Leaves, OfATwistedTorusCloseAfterTheirTurns) {
    // 8 columns shifted by 2: two leaves of F*, each 4 times around.
    const Sampled leaves = sampled(testing::slanted_torus(10.0, 40.0, 2.6), 6, 8);
    EXPECT_EQ(leaves.weft.size(), 6U);
    ASSERT_EQ(leaves.warp.size(), 2U);
    for (const Leaf& leaf : leaves.warp) {
        EXPECT_TRUE(leaf.closed);
        EXPECT_GT(length(leaf), 4.0 * 140.0 * std::numbers::pi);
    }
}

TEST(Leaves, LieOnTheSurface) {
    const Foliation torus = testing::round_torus(100.0, 25.0);
    const ClosestPoint surface(torus.cylinders[0].mesh);
    for (const auto& family : {sampled(torus, 10, 6).weft, sampled(torus, 10, 6).warp}) {
        for (const Leaf& leaf : family) {
            for (const Vector3d& point : leaf.points) {
                EXPECT_LT(surface.query(point).distance, 1e-11);
            }
        }
    }
}

TEST(Leaves, AreThinnedByTheStride) {
    const Sampled leaves = sampled(testing::flat_rectangle(40.0, 20.0), 4, 8, 2);
    ASSERT_EQ(leaves.weft.size(), 3U);
    EXPECT_NEAR(leaves.weft[1].level, 10.0, 1e-12);
    EXPECT_EQ(leaves.warp.size(), 5U);
}

}  // namespace
}  // namespace leafcutter::geometry
