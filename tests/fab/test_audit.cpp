#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "fab/cut/audit.h"
#include "fab/export/formats.h"
#include "geometry/error.h"

namespace leafcutter::fab {
namespace {

CutProgram square_program() {
    CutProgram program;
    program.size = {100.0, 100.0};
    program.cut = {50.0, 1000.0, 1};
    program.score = {50.0, 1000.0, 1};
    program.paths = {{Operation::Score, {{20.0, 30.0}, {40.0, 30.0}}, "W1.1"},
                     {Operation::Cut,
                      {{10.0, 10.0}, {50.0, 10.0}, {50.0, 50.0}, {10.0, 50.0}, {10.0, 10.0}},
                      "W1.1"}};
    return program;
}

std::vector<BurntSegment> exact_burn() {
    return burnt_segments(write_gcode(square_program(), {}, Dialect::Grbl));
}

TEST(Audit, FindsNothingInAnExactBurn) {
    const BurnAudit audit = audit_burn(square_program(), exact_burn());
    EXPECT_NEAR(audit.largest_deviation_mm, 0.0, 1e-12);
    EXPECT_NEAR(audit.largest_gap_mm, 0.0, 1e-12);
    EXPECT_DOUBLE_EQ(audit.burnt_mm, 180.0);
    EXPECT_DOUBLE_EQ(audit.planned_mm, 180.0);
}

TEST(Audit, FindsALineLeftOut) {
    std::vector<BurntSegment> burnt = exact_burn();
    burnt.erase(burnt.begin());  // The score line, in the middle of the square.
    const BurnAudit audit = audit_burn(square_program(), burnt);
    EXPECT_NEAR(audit.largest_deviation_mm, 0.0, 1e-12);
    // Its middle is 20 mm from the bottom and the left side.
    EXPECT_NEAR(audit.largest_gap_mm, 20.0, 0.02);
}

TEST(Audit, FindsABulgeBetweenTwoGoodEnds) {
    std::vector<BurntSegment> burnt = exact_burn();
    const Eigen::Vector2d peak(30.0, 30.3);
    burnt.push_back({{20.0, 30.0}, peak});
    burnt.push_back({peak, {40.0, 30.0}});
    EXPECT_NEAR(audit_burn(square_program(), burnt).largest_deviation_mm, 0.3, 1e-9);
}

TEST(Audit, FindsABurningRapidAcrossTheSquare) {
    std::vector<BurntSegment> burnt = exact_burn();
    burnt.push_back({{10.0, 10.0}, {50.0, 50.0}});
    // Halfway between the score line and the corner at (10, 10): nearest planned lines are 10 mm
    // off.
    EXPECT_NEAR(audit_burn(square_program(), burnt).largest_deviation_mm, 10.0, 0.05);
}

TEST(Audit, CallsAnEmptyBurnAGapAsLargeAsTheSheet) {
    const BurnAudit audit = audit_burn(square_program(), {});
    EXPECT_NEAR(audit.largest_gap_mm, std::hypot(100.0, 100.0), 1e-9);
    EXPECT_EQ(audit.burnt_mm, 0.0);
}

TEST(Audit, HoldsAcrossScalesOfSegments) {
    // A circle burnt in 20,000 tiny steps against a plan of 300: off by the sagitta, r (1 −
    // cos(π/300)).
    CutProgram plan;
    plan.size = {200.0, 200.0};
    CutPath circle;
    const auto on_circle = [](int i, int count) {
        const double angle = 2.0 * 3.14159265358979323846 * i / count;
        return Eigen::Vector2d(100.0 + 80.0 * std::cos(angle), 100.0 + 80.0 * std::sin(angle));
    };
    for (int i = 0; i <= 300; ++i) {
        circle.points.push_back(on_circle(i, 300));
    }
    plan.paths = {circle};
    std::vector<BurntSegment> burnt;
    for (int i = 0; i < 20'000; ++i) {
        burnt.push_back({on_circle(i, 20'000), on_circle(i + 1, 20'000)});
    }
    const BurnAudit audit = audit_burn(plan, burnt);
    const double sagitta = 80.0 * (1.0 - std::cos(3.14159265358979323846 / 300.0));
    EXPECT_NEAR(audit.largest_deviation_mm, sagitta, 1e-4);
    EXPECT_NEAR(audit.largest_gap_mm, sagitta, 1e-4);
}

TEST(BurntSegments, AreThoseUnderPowerOnly) {
    const auto burnt = burnt_segments(
        "; M3 S1000\nG21\nG90\nM4 S0\nG0 X5 Y5 S0\nG1 X10 Y5 S300 F900\nX10 Y8\nG1 X0 Y0 S0\n"
        "G0 X1 Y1\nM5 S0\nG1 X9 Y9 S500\nG0 X0 Y0\n");
    ASSERT_EQ(burnt.size(), 2U);
    EXPECT_EQ(burnt[0].from, Eigen::Vector2d(5.0, 5.0));
    EXPECT_EQ(burnt[0].to, Eigen::Vector2d(10.0, 5.0));
    EXPECT_EQ(burnt[1].to, Eigen::Vector2d(10.0, 8.0));
}

TEST(BurntSegments, RefuseWhatTheyCannotFollow) {
    EXPECT_THROW(burnt_segments("G2 X1 Y1 I1 J0\n"), geometry::Error);
    EXPECT_THROW(burnt_segments("G91\n"), geometry::Error);
    EXPECT_THROW(burnt_segments("G1 X\n"), geometry::Error);
    EXPECT_THROW(burnt_segments("hello\n"), geometry::Error);
}

}  // namespace
}  // namespace leafcutter::fab
