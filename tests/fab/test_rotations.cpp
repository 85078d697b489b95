// Sets of rotations, and a search that keeps to them.

#include <cmath>

#include <gtest/gtest.h>

#include "fab/nest/instance.h"
#include "fab/nest/random.h"
#include "fab/nest/rotations.h"

namespace leafcutter::fab {
namespace {

Rotations along_or_back() {
    return Rotations(std::vector<AngleInterval>{{-5.0, 5.0}, {175.0, 185.0}});
}

TEST(Rotations, AllowWhatLiesInAnIntervalWhateverTheTurns) {
    const Rotations set = along_or_back();
    for (const double fine : {-5.0, 0.0, 5.0, 180.0, -180.0, -175.5, 540.0, 355.0}) {
        EXPECT_TRUE(set.allows(fine, 1e-9)) << fine;
    }
    for (const double wrong : {-5.1, 6.0, 90.0, 174.0, -174.0}) {
        EXPECT_FALSE(set.allows(wrong, 1e-9)) << wrong;
    }
    EXPECT_TRUE(Rotations().allows(123.0, 0.0));
}

TEST(Rotations, SnapToTheNearestEnd) {
    const Rotations set = along_or_back();
    EXPECT_EQ(set.nearest(3.0), 3.0);
    EXPECT_EQ(set.nearest(40.0), 5.0);
    EXPECT_EQ(std::remainder(set.nearest(-170.0) - 185.0, 360.0), 0.0);
    EXPECT_EQ(Rotations({0.0, 180.0}).nearest(100.0), 180.0);
}

TEST(Rotations, StepsEndAtTheEndOfTheInterval) {
    const Rotations set = along_or_back();
    EXPECT_DOUBLE_EQ(set.step(3.0, 10.0), 2.0);
    EXPECT_DOUBLE_EQ(set.step(-178.0, 100.0), 3.0);
    EXPECT_DOUBLE_EQ(set.step(0.0, -2.0), -2.0);
    EXPECT_DOUBLE_EQ(Rotations({90.0}).step(90.0, 7.0), 0.0);
    EXPECT_DOUBLE_EQ(Rotations().step(90.0, 777.0), 777.0);
}

TEST(Rotations, SamplesAndSharesStayInside) {
    const Rotations set(std::vector<AngleInterval>{{-7.0, 1.0}, {90.0, 90.0}});
    Random random(1);
    int straight = 0;
    for (int i = 0; i < 1000; ++i) {
        const double angle = set.at_share(random.unit());
        EXPECT_TRUE(set.allows(angle, 1e-9)) << angle;
        straight += angle == 90.0 ? 1 : 0;
    }
    EXPECT_NEAR(straight, 111, 40);  // One of nine degrees.
    for (const double angle : set.samples()) {
        EXPECT_TRUE(set.allows(angle, 1e-9)) << angle;
    }
    EXPECT_EQ(set.samples().back(), 90.0);
}

TEST(Rotations, AWholeTurnIsAny) {
    EXPECT_TRUE(Rotations(std::vector<AngleInterval>{{0.0, 360.0}}).empty());
    EXPECT_FALSE(along_or_back().is_list());
    EXPECT_TRUE(Rotations({0.0, 90.0}).is_list());
}

// Slightly tapered bars, some of which may lean.
TEST(Rotations, AreKeptToByTheSearch) {
    NestInstance instance;
    instance.strip_height = 30.0;
    for (int i = 0; i < 6; ++i) {
        InstanceItem item;
        item.id = i;
        item.outline = {{0.0, 0.0}, {25.0, 0.0}, {25.0, 4.0 + i}, {0.0, 6.0}};
        item.allowed_deg = i % 2 == 0
                               ? along_or_back()
                               : Rotations(std::vector<AngleInterval>{{80.0, 85.0}, {0.0, 0.0}});
        instance.items.push_back(item);
    }
    CompactionOptions options;
    options.max_evaluations = 60'000;
    const InstanceSolution solution = solve(instance, options, {});
    int leaning = 0;
    for (const InstancePlacement& at : solution.layouts.front().placed) {
        EXPECT_TRUE(instance.items[at.item].allowed_deg.allows(at.rotation_deg, 1e-9));
        leaning += std::remainder(at.rotation_deg, 90.0) != 0.0 ? 1 : 0;
    }
    EXPECT_EQ(solution.layouts.front().placed.size(), 6U);
    EXPECT_GT(leaning, 0);
}

}  // namespace
}  // namespace leafcutter::fab
