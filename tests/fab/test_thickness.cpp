#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "fab/weave/thickness.h"

namespace leafcutter::fab {
namespace {

std::vector<Crossing> sides(const std::vector<int>& on_top) {
    std::vector<Crossing> crossings;
    for (const int top : on_top) {
        crossings.push_back({0, 0, top != 0});
    }
    return crossings;
}

double sum(const std::vector<double>& values) {
    double total = 0.0;
    for (const double value : values) {
        total += value;
    }
    return total;
}

TEST(CrimpPath, LeadsFromOneLevelToTheOther) {
    for (const CrimpRule& rule : {CrimpRule{0.2, 0.2, 0.4, 0.0}, CrimpRule{0.2, 0.2, 0.4, 2.0},
                                  CrimpRule{0.6, 0.2, 3.0, 1.0}, CrimpRule{0.2, 3.0, 0.5, 0.1},
                                  CrimpRule{1.5, 0.1, 0.0, 0.0}}) {
        const CrimpPath path = crimp_path(rule, 10.0);
        const double rise = 2.0 * path.radius_mm * (1.0 - std::cos(path.angle_rad)) +
                            path.straight_mm * std::sin(path.angle_rad);
        const double run = 2.0 * path.radius_mm * std::sin(path.angle_rad) +
                           path.straight_mm * std::cos(path.angle_rad);
        EXPECT_NEAR(rise, (rule.own_mm + rule.crossed_mm) / 2.0, 1e-12);
        EXPECT_NEAR(run, path.run_mm, 1e-12);
        EXPECT_GE(path.run_mm, rule.gap_mm);
        EXPECT_GE(path.radius_mm, rule.min_radius_mm - 1e-12);
        EXPECT_GE(path.length_mm(), std::hypot(path.climb_mm, path.run_mm));
    }
}

TEST(CrimpPath, BendsNoTighterThanTheMaterialTakes) {
    const CrimpPath crease = crimp_path({0.2, 0.2, 0.4, 0.0}, 10.0);
    EXPECT_NEAR(crease.run_mm, 0.4, 1e-12);
    EXPECT_EQ(crease.lift_mm, 0.0);

    const CrimpPath stiff = crimp_path({0.2, 0.2, 0.4, 2.0}, 10.0);
    EXPECT_NEAR(stiff.radius_mm, 2.0, 1e-12);
    EXPECT_NEAR(stiff.run_mm, std::sqrt(0.2 * (8.0 - 0.2)), 1e-12);
    EXPECT_GT(stiff.lift_mm, 0.0);

    // A cell that is too short for it: the bend is as tight as it has to be, and says so.
    EXPECT_LT(crimp_path({0.2, 0.2, 0.4, 200.0}, 5.0).radius_mm, 200.0);
}

TEST(CrimpPath, FillsTheGapThatLetsItLieFlat) {
    for (const double radius : {0.1, 0.5, 2.0, 40.0}) {
        CrimpRule rule{0.2, 0.3, 0.0, radius};
        rule.gap_mm = flat_gap_mm(rule);
        const CrimpPath path = crimp_path(rule, 1000.0);
        EXPECT_NEAR(path.run_mm, rule.gap_mm, 1e-12);
        EXPECT_NEAR(path.radius_mm, radius, 1e-9);
        EXPECT_EQ(path.lift_mm, 0.0);
    }
}

TEST(Crimp, CostsOnlyWhereAStripChangesSide) {
    const CrimpRule rule{0.2, 0.4, 0.4, 0.0};
    const double once = crimp_path(rule, 10.0).extra_mm();
    const std::vector<double> lengths(8, 10.0);
    const auto extra = [&](const std::vector<int>& pattern, bool closed) {
        return crimp_extra_mm(sides(pattern), lengths, rule, closed);
    };
    EXPECT_NEAR(sum(extra({1, 0, 1, 0, 1, 0, 1, 0}, true)), 8 * once, 1e-12);
    EXPECT_NEAR(sum(extra({1, 0, 1, 0, 1, 0, 1, 0}, false)), 7 * once, 1e-12);
    EXPECT_NEAR(sum(extra({1, 1, 0, 0, 1, 1, 0, 0}, true)), 4 * once, 1e-12);
    EXPECT_EQ(sum(extra({1, 1, 1, 1, 1, 1, 1, 1}, true)), 0.0);

    const std::vector<double> twill = extra({1, 1, 0, 0, 1, 1, 1, 1}, false);
    EXPECT_EQ(twill[0], 0.0);
    EXPECT_NEAR(twill[1], once / 2.0, 1e-12);
    EXPECT_NEAR(twill[2], once / 2.0, 1e-12);
    EXPECT_EQ(twill[5], 0.0);
    EXPECT_EQ(twill[7], 0.0);
}

TEST(Crimp, IsNoneWithoutThickness) {
    const std::vector<double> lengths(4, 10.0);
    EXPECT_EQ(sum(crimp_extra_mm(sides({1, 0, 1, 0}), lengths, {0.0, 0.0, 0.4, 2.0}, true)), 0.0);
}

TEST(Clearance, LetsTheThickerStripThrough) {
    const ClearanceNeed need = clearance_need({0.2, 2.0}, {1.5, 0.0});
    EXPECT_GT(need.pass_mm, 0.75);
    EXPECT_GE(need.flat_mm, need.pass_mm);
    EXPECT_EQ(need.joint_mm, 1.5) << "two layers of 1.5 mm";
    EXPECT_EQ(automatic_clearance_mm(need, 1.0), need.joint_mm);
    EXPECT_EQ(automatic_clearance_mm(need, 1000.0), std::max(need.joint_mm, need.flat_mm));
    const ClearanceNeed paper = clearance_need({0.2, 2.0}, {0.2, 2.0});
    EXPECT_EQ(automatic_clearance_mm(paper, 1000.0), paper.flat_mm);
    EXPECT_NEAR(automatic_clearance_mm(paper, 10.0), 0.5, 1e-12);
}

}  // namespace
}  // namespace leafcutter::fab
