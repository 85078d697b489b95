#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "fab/cut/estimate.h"
#include "fab/cut/motion.h"
#include "fab/cut/toolpath.h"
#include "fab/nest/collision.h"
#include "geometry/error.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

namespace {

Material paper() {
    Material material;
    material.id = "paper";
    material.kerf_mm = 0.2;
    material.cut = {40.0, 900.0, 1};
    material.score = {15.0, 1500.0, 1};
    material.engrave = {10.0, 2400.0, 1};
    return material;
}

Piece marked_piece(const std::string& id) {
    Piece piece;
    piece.id = id;
    piece.outline = {{0.0, 0.0}, {60.0, 0.0}, {70.0, 6.0}, {60.0, 12.0}, {0.0, 12.0}};
    Mark fold;
    fold.operation = Operation::Score;
    fold.path = {{20.0, 0.0}, {20.0, 12.0}};
    Mark label;
    label.text = "W1";
    label.at = {30.0, 4.0};
    label.height_mm = 3.0;
    piece.marks = {fold, label};
    return piece;
}

Sheet two_pieces() {
    Sheet sheet;
    sheet.id = 3;
    sheet.size = {300.0, 200.0};
    sheet.placements = {{"W1.1", 20.0, 20.0, 0.0, false}, {"W2.1", 120.0, 30.0, 90.0, false}};
    return sheet;
}

CutProgram planned() {
    const std::vector<Piece> pieces{marked_piece("W1.1"), marked_piece("W2.1")};
    return plan_sheet(two_pieces(), pieces, {paper()});
}

TEST(Placement, MirrorsThenTurnsThenMoves) {
    const Placement placement{"W1.1", 10.0, 20.0, 90.0, true};
    EXPECT_LT((placement.apply({3.0, 4.0}) - Eigen::Vector2d(10.0 - 4.0, 20.0 - 3.0)).norm(),
              1e-12);
}

TEST(Toolpath, CutsHalfAKerfOutsideTheOutline) {
    const CutProgram program = planned();
    const std::vector<Piece> pieces{marked_piece("W1.1"), marked_piece("W2.1")};
    int contours = 0;
    for (const CutPath& path : program.paths) {
        if (path.operation != Operation::Cut) {
            continue;
        }
        ++contours;
        EXPECT_EQ(path.points.front(), path.points.back());
        const Placement& placement = two_pieces().placements[path.piece == "W1.1" ? 0 : 1];
        Ring ring;
        for (const Eigen::Vector2d& point : pieces[0].outline) {
            ring.push_back(placement.apply(point));
        }
        for (std::size_t i = 1; i < path.points.size(); ++i) {
            const Segment cut{path.points[i - 1], path.points[i]};
            EXPECT_FALSE(contains(ring, (cut.from + cut.to) / 2.0));
            double nearest = 1e9;
            for (std::size_t k = 0; k < ring.size(); ++k) {
                nearest = std::min(
                    nearest, squared_distance(cut, Segment{ring[k], ring[(k + 1) % ring.size()]}));
            }
            EXPECT_NEAR(std::sqrt(nearest), 0.1, 1e-5);
        }
    }
    EXPECT_EQ(contours, 2);
}

TEST(Toolpath, EngravesThenScoresThenCuts) {
    const CutProgram program = planned();
    EXPECT_TRUE(std::is_sorted(
        program.paths.begin(), program.paths.end(),
        [](const CutPath& a, const CutPath& b) { return a.operation < b.operation; }));
    std::map<Operation, int> count;
    for (const CutPath& path : program.paths) {
        ++count[path.operation];
    }
    EXPECT_EQ(count[Operation::Score], 2);
    EXPECT_EQ(count[Operation::Cut], 2);
    EXPECT_GE(count[Operation::Engrave], 4) << "two labels of two letters";
}

TEST(Toolpath, CutsAMirroredPieceOutsideToo) {
    Sheet sheet = two_pieces();
    sheet.placements = {{"W1.1", 100.0, 20.0, 0.0, true}};
    const std::vector<Piece> pieces{marked_piece("W1.1")};
    const CutProgram program = plan_sheet(sheet, pieces, {paper()});
    const double outline = std::abs(signed_area(pieces[0].outline));
    const double cut = std::abs(signed_area(program.paths.back().points));
    EXPECT_GT(cut, outline);
    EXPECT_LT(cut, outline + 0.1 * 170.0);
}

TEST(Toolpath, BurnsADoubledMarkOnce) {
    std::vector<Piece> pieces{marked_piece("W1.1"), marked_piece("W2.1")};
    const std::size_t paths = plan_sheet(two_pieces(), pieces, {paper()}).paths.size();
    Mark again = pieces[0].marks[0];
    std::reverse(again.path.begin(), again.path.end());
    pieces[0].marks.push_back(again);
    EXPECT_EQ(plan_sheet(two_pieces(), pieces, {paper()}).paths.size(), paths);
}

TEST(Toolpath, RefusesASheetWithAPieceItDoesNotHave) {
    const std::vector<Piece> pieces{marked_piece("W1.1")};
    EXPECT_THROW(plan_sheet(two_pieces(), pieces, {paper()}), geometry::Error);
}

CutProgram line_program(double length_mm, int passes) {
    CutProgram program;
    program.cut = {50.0, 600.0, passes};
    program.paths = {{Operation::Cut, {{0.0, 0.0}, {length_mm, 0.0}}, "W1.1"}};
    return program;
}

TEST(Motions, RepeatAnOpenPathBackwardOnTheSecondPass) {
    const std::vector<Motion> moves = motions(line_program(100.0, 2), {});
    ASSERT_EQ(moves.size(), 2U) << "ends where it began: no way home";
    EXPECT_EQ(moves[0].to, Eigen::Vector2d(100.0, 0.0));
    EXPECT_EQ(moves[1].to, Eigen::Vector2d(0.0, 0.0));
    EXPECT_TRUE(moves[1].burns);
}

TEST(Estimate, IsATrapezoidForASingleLine) {
    // 100 mm at 10 mm/s with 500 mm/s²: d/v + v/a. Back at 100 mm/s: 1 + 0.2 s.
    const CutEstimate estimate = estimate_cut(line_program(100.0, 1), {});
    EXPECT_NEAR(estimate.seconds, (10.0 + 0.02) + (1.0 + 0.2), 0.02);
    EXPECT_DOUBLE_EQ(estimate.burn_mm, 100.0);
    EXPECT_DOUBLE_EQ(estimate.travel_mm, 100.0);
}

TEST(Estimate, DoesNotSlowDownInAStraightLineOfManyPoints) {
    CutProgram program = line_program(100.0, 1);
    Polyline& points = program.paths[0].points;
    points.clear();
    for (int i = 0; i <= 1000; ++i) {
        points.emplace_back(0.1 * i, 0.0);
    }
    EXPECT_NEAR(estimate_cut(program, {}).seconds, estimate_cut(line_program(100.0, 1), {}).seconds,
                1e-6);
}

TEST(Estimate, SlowsDownAtCorners) {
    CutProgram program = line_program(100.0, 1);
    program.cut.feed_mm_per_min = 6000.0;
    program.paths[0].points = {{0.0, 0.0}, {10.0, 0.0}, {10.0, 10.0}, {0.0, 10.0}, {0.0, 0.0}};
    const double seconds = estimate_cut(program, {}).seconds;
    EXPECT_GT(seconds, 4.0 * std::sqrt(4.0 * 10.0 / 500.0) * 0.75) << "4 sides, nearly from rest";
    EXPECT_LT(seconds, 4.0 * 2.0 * std::sqrt(10.0 / 500.0) + 1e-9) << "but not quite";
}

}  // namespace
}  // namespace leafcutter::fab
