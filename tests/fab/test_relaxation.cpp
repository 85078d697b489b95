// Parts that move all at once.

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "fab/nest/contacts.h"
#include "fab/nest/insertion.h"
#include "fab/nest/mate.h"
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

// A quarter of a ring, 10 wide, 100 across.
Ring bent_band() {
    constexpr int kParts = 12;
    Ring ring;
    for (int side = 0; side < 2; ++side) {
        for (int i = 0; i <= kParts; ++i) {
            const double share = static_cast<double>(side == 0 ? i : kParts - i) / kParts;
            const double angle = 0.5 * std::numbers::pi * share;
            const double radius = side == 0 ? 100.0 : 90.0;
            ring.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
        }
    }
    return ring;
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

TEST(NearestEdge, TakesVerticesThatAreOneAsFloats) {
    NestPart part = make_part(rectangle(10.0, 100.0), 0.0, {});
    part.outline = {{5.0, 50.0}, {5.0 - 1e-9, 50.0}, {-5.0, 50.0}, {-5.0, -50.0}, {5.0, -50.0}};
    const auto foot = foot_of(turned(part), {6.0, 51.0}, 10.0);
    ASSERT_TRUE(foot);
    EXPECT_TRUE(std::isfinite(foot->distance));
    EXPECT_TRUE(foot->point.allFinite());
    EXPECT_NEAR(foot->normal.norm(), 1.0, 1e-5);
}

TEST(Part, OfASliverHasFewVertices) {
    EXPECT_LT(make_part(rectangle(1e-5, 500.0), 0.0, {}).outline.size(), 200U);
}

TEST(NearestEdge, FindsForAllVerticesWhatItFindsForEach) {
    const TurnedPart band = turned(make_part(bent_band(), 0.0, {}));
    constexpr double kNear = 6.0;
    std::vector<VertexBlock> among;
    std::vector<VertexFoot> feet;
    for (const Eigen::Vector2d& shift : {Eigen::Vector2d(12.0, 3.0), Eigen::Vector2d(-8.0, 40.0)}) {
        near_blocks({band, band, shift, 2.0 * kNear}, among);
        feet_among({band, band, shift, kNear}, among, feet);
        ASSERT_FALSE(feet.empty());
        auto next = feet.begin();
        for (std::size_t i = 0; i < band.edges; ++i) {
            const auto foot = foot_of(band, Eigen::Vector2d(band.x0[i], band.y0[i]) + shift, kNear);
            const bool listed = next != feet.end() && next->vertex == i;
            ASSERT_EQ(listed, foot.has_value());
            if (listed) {
                EXPECT_EQ(next->foot.distance, foot->distance);
                ++next;
            }
        }
    }
}

TEST(Contacts, ForgetNothingAsPartsMove) {
    BoardPlan plan = plan_of(8, 300.0);
    plan.parts[0] = make_part(bent_band(), 0.0, {});
    Board board(plan);
    board.restore(in_a_row(8, 14.0, 100.0), {1, 400.0});
    Contacts kept(board);
    Random random(5);
    for (int step = 0; step < 200; ++step) {
        const std::size_t item = random.below(8);
        Position to = board.position(item);
        to.x += random.between(-1.5, 1.5);
        to.y += random.between(-1.5, 1.5);
        to.angle_deg += random.between(-1.0, 1.0);
        board.move(item, to);
        const std::vector<Contact>& now = kept.find();
        Contacts fresh(board);
        const std::vector<Contact>& anew = fresh.find();
        ASSERT_EQ(now.size(), anew.size());
        for (std::size_t k = 0; k < now.size(); ++k) {
            ASSERT_EQ(now[k].item, anew[k].item);
            ASSERT_EQ(now[k].other, anew[k].other);
            ASSERT_EQ(now[k].want, anew[k].want);
        }
    }
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

TEST(Relaxation, FreesRectanglesThatLieEdgeByEdge) {
    const BoardPlan plan = plan_of(20, 120.0);
    Board board(plan);
    std::vector<Position> positions = in_a_row(20, 9.8, 55.0);
    for (Position& at : positions) {
        at.y = 55.0;
    }
    board.restore(positions, {1, 200.1});
    ASSERT_FALSE(board.clashes().empty());
    EXPECT_TRUE(Relaxation(board).relax(30));
}

// Its diagonal stands upright: turned either way it is lower, but not at first.
TEST(Relaxation, KnocksLooseWhatJamsAtItsFullLength) {
    const BoardPlan plan = plan_of(1, 100.48);
    Board board(plan);
    std::vector<Position> positions(1);
    positions[0].x = 50.0;
    positions[0].y = 50.24;
    positions[0].angle_deg = std::atan2(10.0, 100.0) * 180.0 / std::numbers::pi;
    board.restore(positions, {1, 100.0});
    ASSERT_FALSE(board.clashes().empty());
    EXPECT_FALSE(Relaxation(board).relax(24));
    board.restore(positions, {1, 100.0});
    EXPECT_TRUE(Relaxation(board).relax(16, 3));
    EXPECT_TRUE(board.clashes().empty());
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
    Relaxation relaxation(board);
    relaxation.settle();
    EXPECT_LT(board.extent().last_width, 200.0);
    EXPECT_TRUE(relaxation.press());
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
    Relaxation relaxation(board);
    relaxation.settle();
    relaxation.press();
    for (const Position& at : board.positions()) {
        EXPECT_LE(std::abs(at.angle_deg), 1.0 + 1e-9);
    }
}

TEST(Mate, LiesAlongTheOtherAndTouchesIt) {
    BoardPlan plan = plan_of(2, 400.0);
    plan.parts[0] = make_part(bent_band(), 0.0, {});
    Board board(plan);
    Random random(7);
    for (int tries = 0; tries < 50; ++tries) {
        std::vector<Position> positions(2);
        positions[1].x = random.between(150.0, 250.0);
        positions[1].y = random.between(150.0, 250.0);
        positions[1].angle_deg = random.between(-180.0, 180.0);
        board.restore(positions, {1, 400.0});
        const auto mate = best_mate(plan, 0, 200, random);
        ASSERT_TRUE(mate);
        EXPECT_EQ(mate->item, 0U);
        EXPECT_EQ(mate->other, 1U);
        EXPECT_GT(mate->overlap, 45.0);  // A third of its length.
        EXPECT_LT(mate->misfit, 5.0);
        board.move(0, mated(board, *mate));
        const std::vector<Contact> contacts = Contacts(board).find();
        ASSERT_FALSE(contacts.empty());
        for (const Contact& contact : contacts) {
            EXPECT_LT(contact.want, 5.0);
        }
    }
}

TEST(Mate, IsNobodysWhereNobodyElseIsABand) {
    const BoardPlan plan = plan_of(1, 400.0);
    Random random(7);
    EXPECT_FALSE(best_mate(plan, 0, 20, random));
}

TEST(Mate, ABandThatSlidAlongItselfIsWhereItWas) {
    const NestPart band = make_part(bent_band(), 0.0, {});
    Position at;
    at.angle_deg = 30.0;
    EXPECT_TRUE(is_same_place(band, at, at));
    Position aside = at;
    aside.x += 4.0;
    EXPECT_TRUE(is_same_place(band, aside, at));
    aside.x += 26.0;
    aside.y += 26.0;
    EXPECT_FALSE(is_same_place(band, aside, at));
    Position other_sheet = at;
    other_sheet.bin = 1;
    EXPECT_FALSE(is_same_place(band, other_sheet, at));
}

// Two rows of bands, the upper one with a hole: a band of the last column fits there.
TEST(Insertion, TakesABandToWhereThereIsRoom) {
    const BoardPlan plan = plan_of(10, 201.0);
    Packing start;
    start.extent = {1, 61.0};
    for (int i = 0; i < 10; ++i) {
        Position at;
        at.x = 5.1 + 10.1 * (i < 5 ? i : i == 9 ? 5 : i - 5);
        at.y = i < 5 || i == 9 ? 50.1 : 150.5;
        start.positions.push_back(at);
    }
    Board board(plan);
    board.restore(start.positions, start.extent);
    ASSERT_TRUE(board.clashes().empty());
    Insertion insertion(plan, 3);
    const Packing settled = insertion.settle(start);
    EXPECT_LE(settled.extent.last_width, start.extent.last_width);
    double least = start.extent.last_width;
    for (int tries = 0; tries < 100; ++tries) {
        if (const auto pressed = insertion.attempt(settled, 0.002)) {
            board.restore(pressed->packing.positions, pressed->packing.extent);
            ASSERT_TRUE(board.clashes().empty());
            EXPECT_LE(pressed->settled.extent.last_width, 1.01 * settled.extent.last_width);
            least = std::min(least, pressed->packing.extent.last_width);
        }
    }
    EXPECT_LT(least, 51.0);
    EXPECT_GT(insertion.evaluations(), 0);
}

}  // namespace
}  // namespace leafcutter::fab
