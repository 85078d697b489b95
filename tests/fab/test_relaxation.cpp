// Parts that move all at once.

#include <cmath>

#include <gtest/gtest.h>

#include "fab/nest/nearest_edge.h"
#include "fab/nest/relaxation.h"

namespace leafcutter::fab {
namespace {

Ring rectangle(double width, double height) {
    return {{0.0, 0.0}, {width, 0.0}, {width, height}, {0.0, height}};
}

// Rectangles of 10 x 100 that turn freely.
BoardPlan plan_of(std::size_t count, double height) {
    BoardPlan plan;
    plan.parts.push_back(make_part(rectangle(10.0, 100.0), 0.0, {}));
    plan.turned.emplace_back();
    plan.part_of.assign(count, 0);
    plan.rooms.push_back({1000.0, height});
    return plan;
}

std::vector<Position> in_a_row(std::size_t count, double apart, double y) {
    std::vector<Position> positions(count);
    for (std::size_t i = 0; i < count; ++i) {
        positions[i].x = 5.0 + apart * static_cast<double>(i);
        positions[i].y = i % 2 == 0 ? y : y + 10.0;
    }
    return positions;
}

TurnedPart turned(const NestPart& part) {
    TurnedPart out;
    turn_part(part, 0.0, out);
    return out;
}

TEST(NearestEdge, MeasuresFromOutsideAndFromInside) {
    const NestPart part = make_part(rectangle(10.0, 100.0), 0.0, {});
    const TurnedPart shape = turned(part);
    const auto outside = foot_of(shape, {8.0, 20.0}, 10.0);
    ASSERT_TRUE(outside);
    EXPECT_NEAR(outside->distance, 3.0, 1e-5);
    EXPECT_NEAR(outside->normal.x(), 1.0, 1e-6);
    const auto inside = foot_of(shape, {-4.0, 20.0}, 10.0);
    ASSERT_TRUE(inside);
    EXPECT_NEAR(inside->distance, -1.0, 1e-5);
    EXPECT_NEAR(inside->normal.x(), -1.0, 1e-6);
    EXPECT_NEAR(inside->point.x(), -5.0, 1e-5);
    EXPECT_FALSE(foot_of(shape, {20.0, 0.0}, 10.0));
}

TEST(NearestEdge, PointsAwayFromACorner) {
    const NestPart part = make_part(rectangle(10.0, 100.0), 0.0, {});
    const auto foot = foot_of(turned(part), {8.0, 54.0}, 10.0);
    ASSERT_TRUE(foot);
    EXPECT_NEAR(foot->distance, 5.0, 1e-5);
    EXPECT_NEAR(foot->normal.x(), 0.6, 1e-5);
    EXPECT_NEAR(foot->normal.y(), 0.8, 1e-5);
}

TEST(Relaxation, FreesALongRowThatOverlapsAllOver) {
    const BoardPlan plan = plan_of(20, 120.0);
    Board board(plan);
    board.restore(in_a_row(20, 9.8, 55.0), {1, 200.1});
    ASSERT_FALSE(board.clashes().empty());
    Relaxation relaxation(board);
    EXPECT_TRUE(relaxation.relax(30));
    EXPECT_TRUE(board.clashes().empty());
    EXPECT_GT(relaxation.evaluations(), 0);
}

TEST(Relaxation, SaysSoWhereThereIsNoRoom) {
    const BoardPlan plan = plan_of(20, 120.0);
    Board board(plan);
    board.restore(in_a_row(20, 9.8, 55.0), {1, 199.0});
    EXPECT_FALSE(Relaxation(board).relax(30));
}

TEST(Relaxation, PressesARowUntilAllTouch) {
    const BoardPlan plan = plan_of(20, 120.0);
    Board board(plan);
    std::vector<Position> positions = in_a_row(20, 15.0, 55.0);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        positions[i].angle_deg = i % 2 == 0 ? 0.2 : -0.2;
        positions[i].x += 2.0;
    }
    board.restore(positions, {1, 300.0});
    ASSERT_TRUE(board.clashes().empty());
    EXPECT_TRUE(Relaxation(board).press());
    EXPECT_TRUE(board.clashes().empty());
    EXPECT_NEAR(board.extent().last_width, 200.0, 0.5);
    EXPECT_GE(board.extent().last_width, 200.0);
}

TEST(Relaxation, LeavesWhatIsFixedWhereItIs) {
    BoardPlan plan = plan_of(2, 200.0);
    BoardPlan::Fixed fixed;
    fixed.shape = turned(plan.parts[0]);
    shift_part(fixed.shape, 25.0F, 80.0F);
    plan.fixed.push_back(fixed);
    Board board(plan);
    std::vector<Position> positions = in_a_row(2, 30.2, 50.0);
    positions[0].x = 15.5;  // Both reach into it.
    positions[1].x = 34.5;
    board.restore(positions, {1, 60.0});
    ASSERT_FALSE(board.clashes().empty());
    EXPECT_TRUE(Relaxation(board).relax(30));
    EXPECT_LE(board.position(0).x, 15.0);
    EXPECT_GE(board.position(1).x, 35.0);
}

TEST(Relaxation, TurnsOnlyAsFarAsAPartMay) {
    BoardPlan plan;
    plan.parts.push_back(
        make_part(rectangle(10.0, 100.0), 0.0, Rotations(std::vector<AngleInterval>{{-1.0, 1.0}})));
    plan.turned.emplace_back();
    plan.part_of.assign(2, 0);
    plan.rooms.push_back({1000.0, 105.0});
    Board board(plan);
    std::vector<Position> positions = in_a_row(2, 13.0, 52.5);
    positions[0].angle_deg = 1.0;
    positions[1].angle_deg = -1.0;
    board.restore(positions, {1, 40.0});
    Relaxation(board).press();
    for (const Position& at : board.positions()) {
        EXPECT_LE(std::abs(at.angle_deg), 1.0 + 1e-9);
    }
}

}  // namespace
}  // namespace leafcutter::fab
