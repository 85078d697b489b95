// Bands that bend alike come together.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "fab/nest/bend_order.h"

namespace leafcutter::fab {
namespace {

// 10 wide, of a length; turns by that many radians in each half.
Ring band(double length, double first_turn, double second_turn) {
    constexpr int kSteps = 40;
    Ring left;
    Ring right;
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    double angle = 0.0;
    for (int i = 0; i <= kSteps; ++i) {
        const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
        const Eigen::Vector2d normal(-along.y(), along.x());
        left.push_back(at + 5.0 * normal);
        right.push_back(at - 5.0 * normal);
        angle += (2 * i < kSteps ? first_turn : second_turn) / (0.5 * kSteps);
        at += length / kSteps * along;
    }
    right.insert(right.end(), left.rbegin(), left.rend());
    return right;
}

NestPart part(double length, double first_turn, double second_turn) {
    return make_part(band(length, first_turn, second_turn), 0.0, {});
}

TEST(BendOrder, TellsArcsFromStraightOnesAndFromThoseThatBendBothWays) {
    const BandBend arc = bend_of(part(300.0, 0.4, 0.4));
    EXPECT_FALSE(arc.first_right);
    EXPECT_NEAR(arc.by, 0.8 / 300.0, 0.3 / 300.0);
    // Which of its ends comes first does not matter.
    EXPECT_NEAR(bend_of(part(300.0, -0.4, -0.4)).by, arc.by, 1e-3 * arc.by);
    EXPECT_FALSE(bend_of(part(300.0, -0.4, -0.4)).first_right);
    const BandBend one = bend_of(part(300.0, 0.4, -0.4));
    const BandBend mirrored = bend_of(part(300.0, -0.4, 0.4));
    EXPECT_NEAR(one.by, -arc.by, 0.3 * arc.by);
    EXPECT_NEAR(mirrored.by, one.by, 0.1 * arc.by);
    EXPECT_NE(one.first_right, mirrored.first_right);
    EXPECT_NEAR(bend_of(part(300.0, 0.0, 0.0)).by, 0.0, 1e-6);
    EXPECT_EQ(bend_of(make_part({{0.0, 0.0}, {50.0, 0.0}, {50.0, 50.0}, {0.0, 50.0}}, 0.0, {})),
              BandBend());
}

TEST(BendOrder, HasEachItemOnceAndThoseAlikeTogether) {
    BoardPlan plan;
    for (const double length : {200.0, 300.0, 400.0}) {
        plan.parts.push_back(part(length, 0.4, 0.4));
        plan.parts.push_back(part(length, 0.0, 0.0));
        plan.parts.push_back(part(length, 0.4, -0.4));
    }
    plan.turned.resize(plan.parts.size());
    for (std::size_t i = 0; i < 90; ++i) {
        plan.part_of.push_back(i * 7 % plan.parts.size());
    }
    const std::vector<std::size_t> order = by_bend(plan, 3);
    ASSERT_EQ(order.size(), 90U);
    EXPECT_EQ(std::set<std::size_t>(order.begin(), order.end()).size(), 90U);
    for (std::size_t i = 0; i < order.size(); ++i) {
        // Those that bend both ways, straight ones, arcs.
        EXPECT_EQ(plan.part_of[order[i]] % 3, 2 - i / 30) << i;
        if (i % 30 > 0) {
            EXPECT_GE(plan.part(order[i - 1]).diameter + 1e-9, plan.part(order[i]).diameter) << i;
        }
    }
}

TEST(BendOrder, TakesMoreGroupsThanItems) {
    BoardPlan plan;
    plan.parts.push_back(part(200.0, 0.4, 0.4));
    plan.part_of = {0, 0};
    EXPECT_EQ(by_bend(plan, 8).size(), 2U);
    plan.part_of.clear();
    EXPECT_TRUE(by_bend(plan, 8).empty());
}

}  // namespace
}  // namespace leafcutter::fab
