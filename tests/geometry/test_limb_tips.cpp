// Tips of limbs: found where limbs are, and nowhere else.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/limb_tips.h"
#include "geometry/samples.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;

std::vector<int> long_limbs(const TriangleMesh& mesh) {
    std::vector<int> tips;
    for (const LimbTip& tip : find_limb_tips(mesh, {}, {})) {
        if (tip.persistence >= 0.04) {
            tips.push_back(tip.vertex);
        }
    }
    return tips;
}

// A sphere, or a disk without its lower cap, that is drawn out along some directions.
TriangleMesh make_star(const std::vector<Eigen::Vector3d>& arms) {
    TriangleMesh mesh = make_sample("sphere", 8000);
    for (Eigen::Vector3d& p : mesh.positions) {
        const Eigen::Vector3d direction = p.normalized();
        double radius = 1.0;
        for (const Eigen::Vector3d& arm : arms) {
            radius += 3.0 * std::exp(8.0 * (direction.dot(arm.normalized()) - 1.0) * 4.0);
        }
        p = radius * direction;
    }
    return mesh;
}

void expect_tips_at(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& arms) {
    const std::vector<int> tips = long_limbs(mesh);
    ASSERT_EQ(tips.size(), arms.size());
    for (const Eigen::Vector3d& arm : arms) {
        const bool found = std::any_of(tips.begin(), tips.end(), [&](int v) {
            return (mesh.positions[at(v)] - 4.0 * arm.normalized()).norm() < 0.3;
        });
        EXPECT_TRUE(found) << arm.transpose();
    }
}

TEST(LimbTips, AreAtTheEndsOfEveryLimb) {
    const std::vector<Eigen::Vector3d> arms{
        {1, 0, 0}, {-1, 0.2, 0}, {0, 1, 0.3}, {0, -1, 0}, {0.1, 0, 1}};
    expect_tips_at(make_star(arms), arms);
    expect_tips_at(testing::renumbered(make_star(arms)), arms);
}

TEST(LimbTips, AreSortedByPersistence) {
    const std::vector<LimbTip> tips = find_limb_tips(make_sample("hand", 8000), {}, {});
    EXPECT_TRUE(std::is_sorted(tips.begin(), tips.end(), [](const LimbTip& a, const LimbTip& b) {
        return a.persistence > b.persistence;
    }));
}

TEST(LimbTips, AFlatOrRoundSurfaceHasNone) {
    EXPECT_TRUE(long_limbs(testing::make_square(30)).empty());
    EXPECT_TRUE(long_limbs(make_sample("sphere", 3000)).empty());
    EXPECT_TRUE(long_limbs(testing::make_prism(20, 60, 0.2, 2.0)).empty());
}

// A finger on a plate has a tip. Open at its end it has none: its limb ends in a boundary.
TEST(LimbTips, ALimbThatEndsInABoundaryHasNone) {
    TriangleMesh finger = testing::make_finger(60, 2.0);
    ASSERT_EQ(long_limbs(finger).size(), 1U);
    EXPECT_GT(finger.positions[at(long_limbs(finger)[0])].z(), 2.0);
    auto& triangles = finger.triangles;
    triangles.erase(std::remove_if(triangles.begin(), triangles.end(),
                                   [&](const std::array<int, 3>& t) {
                                       return finger.positions[at(t[0])].z() > 2.0;
                                   }),
                    triangles.end());
    std::vector<int> place(finger.positions.size(), -1);
    TriangleMesh open;
    for (auto& t : triangles) {
        for (int& v : t) {
            if (place[at(v)] < 0) {
                place[at(v)] = static_cast<int>(open.positions.size());
                open.positions.push_back(finger.positions[at(v)]);
            }
            v = place[at(v)];
        }
        open.triangles.push_back(t);
    }
    EXPECT_TRUE(long_limbs(open).empty());
}

TEST(LimbTips, ALimbsRadiusIsThatOfItsTube) {
    const TriangleMesh finger = testing::make_finger(120, 2.0);  // 0.1 thick all round.
    const int tip = long_limbs(finger).at(0);
    EXPECT_NEAR(limb_radius(finger, tip, 1.0), 0.1, 0.035);
    EXPECT_DOUBLE_EQ(limb_radius(finger, tip, 0.02), 0.02);
}

TEST(FarthestVertices, AreSpreadOverTheSurface) {
    const TriangleMesh sphere = make_sample("sphere", 6000);
    const std::vector<int> four = farthest_vertices(sphere, {}, 4, {});
    ASSERT_EQ(four.size(), 4U);
    Eigen::Vector3d low = sphere.positions[0];
    Eigen::Vector3d high = low;
    for (const Eigen::Vector3d& p : sphere.positions) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const double radius = 0.5 * (high - low).maxCoeff();
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t k = i + 1; k < 4; ++k) {
            EXPECT_GT((sphere.positions[at(four[i])] - sphere.positions[at(four[k])]).norm(),
                      1.2 * radius);
        }
    }
}

}  // namespace
}  // namespace leafcutter::geometry
