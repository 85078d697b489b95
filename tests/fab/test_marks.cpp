#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fab/strips/labels.h"
#include "fab/strips/mark_room.h"
#include "fab/strips/marks.h"
#include "fab/strips/overlap.h"
#include "fab/strips/strips.h"
#include "tests/support/quad_grids.h"

namespace leafcutter::fab {
namespace {

using Eigen::Vector2d;

struct Marked {
    std::vector<Strip> strips;
    Crossings crossings;
    std::vector<Piece> pieces;
    MarksLeftOut left_out;
    std::vector<std::string> warnings;
};

Marked marked(const geometry::QuadMesh& mesh, const FitParams& fit = {}) {
    const PieceLimits limits{.usable_sheet = {590.0, 390.0}};
    std::vector<std::string> others;
    Marked made;
    made.strips = make_strips(mesh, ColumnRuns::PerCylinder);
    made.crossings = crossings_of(made.strips, weave_cells(mesh, {}));
    for (std::size_t i = 0; i < made.strips.size(); ++i) {
        const PieceRules rules{fit, limits, made.crossings[i]};
        for (Piece& piece : make_pieces(made.strips[i], mesh, rules, others)) {
            made.pieces.push_back(std::move(piece));
        }
    }
    made.left_out = mark_pieces(made.pieces, made.strips, made.crossings, fit, made.warnings);
    return made;
}

// Strips that wind, narrow and widen at random: half the width to twice, bends to 40 degrees.
geometry::QuadMesh winding_grid(const test::GridSize& size, double width_mm, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const double bend = 3.0 * uniform(random);
    const double wave = 1.0 + 4.0 * std::abs(uniform(random));
    const double taper = 0.5 * uniform(random);
    geometry::QuadMesh mesh = test::flat_grid(size, width_mm);
    const double length = size.cols * width_mm;
    for (Eigen::Vector3d& p : mesh.vertices) {
        const double u = p.x() / length;
        const double way = 0.4 * bend * std::sin(wave * u);
        const double across = p.y() * (1.0 + taper * std::cos(2.0 * wave * u));
        const Eigen::Vector3d jitter(uniform(random), uniform(random), uniform(random));
        p = Eigen::Vector3d(p.x() - across * std::sin(way), 0.5 * length * way / wave + across,
                            width_mm * std::sin(3.0 * u)) +
            0.08 * width_mm * jitter;
    }
    return mesh;
}

std::vector<Polyline> strokes_of(const Mark& mark) {
    return mark.text.empty() ? std::vector<Polyline>{mark.path} : mark_strokes(mark);
}

double turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
    return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

double distance(const Vector2d& point, const Vector2d& from, const Vector2d& to) {
    const Vector2d way = to - from;
    const double part = std::clamp((point - from).dot(way) / way.squaredNorm(), 0.0, 1.0);
    return (point - from - part * way).norm();
}

double distance(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
    if (turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0) {
        return 0.0;
    }
    return std::min({distance(a, c, d), distance(b, c, d), distance(c, a, b), distance(d, a, b)});
}

double distance(const Polyline& one, const Polyline& other) {
    double least = 1e9;
    for (std::size_t i = 0; i + 1 < one.size(); ++i) {
        for (std::size_t j = 0; j + 1 < other.size(); ++j) {
            least = std::min(least, distance(one[i], one[i + 1], other[j], other[j + 1]));
        }
    }
    return least;
}

// By brute force: every stroke of every mark against the outline and against all other marks.
void expect_clean(const Piece& piece) {
    Polyline edge = piece.outline;
    edge.push_back(edge.front());
    const RingInterior inside(piece.outline);
    std::vector<std::vector<Polyline>> strokes;
    for (const Mark& mark : piece.marks) {
        strokes.push_back(strokes_of(mark));
        for (const Polyline& stroke : strokes.back()) {
            EXPECT_TRUE(inside.contains(stroke)) << piece.id << " " << mark.text;
            // Lines begin at 5 % of the width, which may be tiny.
            const double least = mark.text.empty() ? 1e-5 : 0.15;
            EXPECT_GT(distance(stroke, edge), least) << piece.id << " " << mark.text;
        }
    }
    for (std::size_t i = 0; i < strokes.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            for (const Polyline& one : strokes[i]) {
                for (const Polyline& other : strokes[j]) {
                    EXPECT_GT(distance(one, other), 0.04)
                        << piece.id << " " << piece.marks[i].text << " " << piece.marks[j].text;
                }
            }
        }
    }
}

bool is_label(const Mark& mark) {
    return mark.text.find('>') != std::string::npos;
}

Vector2d direction(const Mark& mark) {
    const double angle = mark.angle_deg * std::numbers::pi / 180.0;
    return {std::cos(angle), std::sin(angle)};
}

Vector2d middle(const Mark& mark) {
    const Vector2d x = direction(mark);
    return mark.at + mark.height_mm / 2.0 * (text_width(mark.text) * x + Vector2d(-x.y(), x.x()));
}

// The cell whose middle is nearest.
int cell_of(const Piece& piece, const Vector2d& point) {
    int best = 0;
    double least = 1e9;
    for (int i = 0; i < piece.cell_count; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const Vector2d centre = (piece.cut_left[k] + piece.cut_right[k] + piece.cut_left[k + 1] +
                                 piece.cut_right[k + 1]) /
                                4.0;
        if ((centre - point).norm() < least) {
            least = (centre - point).norm();
            best = i;
        }
    }
    return best;
}

Vector2d way_of(const Piece& piece, int cell) {
    const auto i = static_cast<std::size_t>(cell);
    return (piece.cut_left[i + 1] + piece.cut_right[i + 1] - piece.cut_left[i] - piece.cut_right[i])
        .normalized();
}

const Strip& strip_of(const Marked& made, const Piece& piece) {
    return *std::find_if(made.strips.begin(), made.strips.end(),
                         [&](const Strip& strip) { return strip.id == piece.strip; });
}

const Crossing& crossing_at(const Marked& made, const Piece& piece, int cell) {
    const Strip& strip = strip_of(made, piece);
    const auto index = static_cast<std::size_t>(&strip - made.strips.data());
    return made
        .crossings[index][static_cast<std::size_t>(piece.first_cell + cell) % strip.quads.size()];
}

bool contains(const Piece& piece, int cell, const Vector2d& point) {
    const auto i = static_cast<std::size_t>(cell);
    return turn(piece.cut_right[i], piece.cut_left[i], point) < 0.0 &&
           turn(piece.cut_right[i + 1], piece.cut_left[i + 1], point) > 0.0;
}

TEST(Marks, StayInsideAndApartOnRandomBentStrips) {
    for (unsigned seed = 1; seed <= 8; ++seed) {
        for (const double width : {2.5, 6.0, 11.0}) {
            FitParams fit;
            fit.cell_marks = seed % 2 == 0 ? CellMarks::Lines : CellMarks::Ticks;
            fit.max_piece_mm = seed % 3 == 0 ? 60.0 : 900.0;
            for (const Piece& piece : marked(winding_grid({4, 22}, width, seed), fit).pieces) {
                expect_clean(piece);
            }
        }
    }
}

TEST(Marks, StayInsideAndApartOnThinAndBumpyCells) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        for (const Piece& piece : marked(test::bumpy_grid({6, 30}, 8.0, seed)).pieces) {
            expect_clean(piece);
        }
    }
}

// How far along a piece a point lies, 0 to 1, to half a cell.
double part_along(const Piece& piece, const Vector2d& point) {
    double length = 0.0;
    double here = 0.0;
    const int cell = cell_of(piece, point);
    for (int i = 0; i < piece.cell_count; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const double step = (piece.cut_left[k + 1] + piece.cut_right[k + 1] - piece.cut_left[k] -
                             piece.cut_right[k])
                                .norm();
        here += i < cell ? step : (i == cell ? step / 2.0 : 0.0);
        length += step;
    }
    return here / length;
}

TEST(Marks, NameThePieceAtBothEndsTheWayItRuns) {
    int pieces = 0;
    int twice = 0;
    for (const double width : {5.0, 10.0, 20.0}) {
        for (unsigned seed = 1; seed <= 4; ++seed) {
            const Marked made = marked(winding_grid({6, 14}, width, seed));
            for (const Piece& piece : made.pieces) {
                std::vector<double> parts;
                for (const Mark& mark : piece.marks) {
                    if (is_label(mark)) {
                        EXPECT_EQ(mark.text, piece.id + ">");
                        parts.push_back(part_along(piece, middle(mark)));
                        const int cell = cell_of(piece, middle(mark));
                        EXPECT_GT(direction(mark).dot(way_of(piece, cell)), 0.7);
                    }
                }
                ASSERT_FALSE(parts.empty()) << piece.id << " at " << width;
                ASSERT_LE(parts.size(), 2U) << piece.id << " at " << width;
                ++pieces;
                if (parts.size() == 2) {
                    ++twice;
                    EXPECT_LT(parts[0], 0.6) << piece.id << " at " << width;
                    EXPECT_GT(parts[1], 0.4) << piece.id << " at " << width;
                    EXPECT_LT(parts[0], parts[1]) << piece.id << " at " << width;
                }
            }
        }
    }
    EXPECT_GT(twice, 0.9 * pieces);  // Short and narrow ones have room for one.
}

TEST(Marks, PutIdsUnderOtherStripsWhereTheyAreReadableThere) {
    const Marked made = marked(test::flat_grid({12, 12}, 12.0));
    for (const Piece& piece : made.pieces) {
        for (const Mark& mark : piece.marks) {
            if (!mark.text.empty()) {
                const int cell = cell_of(piece, middle(mark));
                EXPECT_FALSE(crossing_at(made, piece, cell).on_top) << mark.text;
                EXPECT_GE(mark.height_mm, 1.5) << mark.text;
            }
        }
    }
}

double narrowest(const Piece& piece) {
    double width = 1e9;
    for (std::size_t i = 0; i < piece.cut_left.size(); ++i) {
        width = std::min(width, (piece.cut_left[i] - piece.cut_right[i]).norm());
    }
    return width;
}

TEST(Marks, NameTheStripThatCrossesInItsCell) {
    const Marked made = marked(winding_grid({7, 30}, 8.0, 5));
    for (const Piece& piece : made.pieces) {
        std::set<int> named;
        for (const Mark& mark : piece.marks) {
            if (mark.text.empty() || mark.text.find_first_of(">+.") != std::string::npos) {
                continue;
            }
            const int cell = cell_of(piece, middle(mark));
            named.insert(cell);
            const Crossing& crossing = crossing_at(made, piece, cell);
            EXPECT_EQ(mark.text, made.strips[static_cast<std::size_t>(crossing.strip)].id);
            for (const Polyline& stroke : mark_strokes(mark)) {
                for (const Vector2d& point : stroke) {
                    EXPECT_TRUE(contains(piece, cell, point)) << piece.id << " " << mark.text;
                }
            }
            const Vector2d way = way_of(piece, cell);
            const bool along = direction(mark).dot(way) > 0.7;
            const bool across = direction(mark).dot(Vector2d(-way.y(), way.x())) > 0.7;
            EXPECT_TRUE(along || across) << piece.id << " " << mark.text;
        }
        if (narrowest(piece) < 4.0) {
            continue;
        }
        ASSERT_FALSE(named.empty()) << piece.id;
        EXPECT_LE(*named.begin(), 3) << piece.id;
        EXPECT_GE(*named.rbegin(), piece.cell_count - 4) << piece.id;
        for (auto cell = named.begin(); std::next(cell) != named.end(); ++cell) {
            EXPECT_LE(*std::next(cell) - *cell, 14) << piece.id;
        }
    }
}

TEST(Marks, NameThePieceThatATabGoesUnder) {
    FitParams fit;
    fit.max_piece_mm = 120.0;
    Marked made = marked(test::flat_grid({2, 30}, 10.0), fit);
    for (const Piece& piece : made.pieces) {
        std::vector<std::string> joints;
        for (const Mark& mark : piece.marks) {
            if (!mark.text.empty() && mark.text[0] == '+') {
                joints.push_back(mark.text);
            }
        }
        const std::vector<std::string>& ids = strip_of(made, piece).pieces;
        const auto at = std::find(ids.begin(), ids.end(), piece.id);
        if (at + 1 == ids.end()) {
            EXPECT_THAT(joints, testing::IsEmpty()) << piece.id;
        } else {
            EXPECT_THAT(joints, testing::ElementsAre("+" + *(at + 1))) << piece.id;
        }
    }
}

// Lines across the strip within a cell, off its rungs.
std::vector<int> bars_of(const Piece& piece) {
    std::vector<int> cells;
    for (const Mark& mark : piece.marks) {
        if (!mark.text.empty() || mark.operation != Operation::Engrave) {
            continue;
        }
        const Vector2d centre = (mark.path.front() + mark.path.back()) / 2.0;
        const bool on_rung = [&] {
            for (std::size_t i = 0; i < piece.cut_left.size(); ++i) {
                if (distance(centre, piece.cut_left[i], piece.cut_right[i]) < 1e-6) {
                    return true;
                }
            }
            return false;
        }();
        if (!on_rung) {
            cells.push_back(cell_of(piece, centre));
        }
    }
    std::sort(cells.begin(), cells.end());
    return cells;
}

TEST(Marks, BarExactlyTheCellsThatLieUnder) {
    FitParams fit;
    const Marked made = marked(test::cylinder_grid({9, 24}, 45.0, 90.0), fit);
    EXPECT_EQ(made.left_out.weave_marks, 0);
    for (const Piece& piece : made.pieces) {
        std::vector<int> under;
        for (int i = 0; i < piece.cell_count; ++i) {
            if (!crossing_at(made, piece, i).on_top) {
                under.push_back(i);
            }
        }
        EXPECT_EQ(bars_of(piece), under) << piece.id;
    }
    fit.weave_marks = false;
    for (const Piece& piece : marked(test::flat_grid({3, 5}, 10.0), fit).pieces) {
        EXPECT_THAT(bars_of(piece), testing::IsEmpty());
    }
}

int ticks_at(const Piece& piece, std::size_t rung) {
    return static_cast<int>(
        std::count_if(piece.marks.begin(), piece.marks.end(), [&](const Mark& mark) {
            return mark.text.empty() && mark.operation == Operation::Engrave &&
                   distance(mark.path.front(), piece.cut_left[rung], piece.cut_right[rung]) <
                       1e-6 &&
                   distance(mark.path.back(), piece.cut_left[rung], piece.cut_right[rung]) < 1e-6;
        }));
}

TEST(Marks, TickBothEndsOfEveryRung) {
    FitParams fit;
    const auto mesh = winding_grid({5, 12}, 10.0, 3);
    const Marked made = marked(mesh, fit);
    EXPECT_EQ(made.left_out.rungs, 0);
    for (const Piece& piece : made.pieces) {
        for (std::size_t i = 1; i + 1 < piece.cut_left.size(); ++i) {
            EXPECT_EQ(ticks_at(piece, i), 2) << piece.id << " rung " << i;
        }
    }
    fit.cell_marks = CellMarks::None;
    for (const Piece& piece : marked(mesh, fit).pieces) {
        EXPECT_EQ(ticks_at(piece, 1), 0);
    }
    fit.cell_marks = CellMarks::Lines;
    fit.labels = false;
    for (const Piece& piece : marked(mesh, fit).pieces) {
        EXPECT_EQ(ticks_at(piece, 1), 1);
    }
}

TEST(Marks, CountTheTicksThatTinyCellsDontCarry) {
    auto mesh = test::flat_grid({1, 20}, 10.0);
    for (Eigen::Vector3d& p : mesh.vertices) {
        p.x() *= 0.06;  // Cells of 0.6 mm.
    }
    const Marked made = marked(mesh);
    int ticks = 0;
    for (std::size_t i = 1; i < 20; ++i) {
        ticks += ticks_at(made.pieces[0], i);
    }
    EXPECT_EQ(ticks % 2, 0);
    EXPECT_GE(made.left_out.rungs, 19 - ticks / 2);
    EXPECT_LE(ticks / 2, 10);
    EXPECT_THAT(made.warnings, testing::Contains(testing::HasSubstr("too short for tick")));
}

TEST(Marks, ScoreCellsThatBendBeyondTheThreshold) {
    auto mesh = test::flat_grid({1, 3}, 10.0);
    mesh.vertices[1].z() = 5.0;
    const auto scores = [&](double degrees) {
        FitParams fit;
        fit.score_deg = degrees;
        const Marked made = marked(mesh, fit);
        std::vector<std::ptrdiff_t> counts;
        for (const Piece& piece : made.pieces) {
            counts.push_back(
                std::count_if(piece.marks.begin(), piece.marks.end(),
                              [](const Mark& mark) { return mark.operation == Operation::Score; }));
        }
        return counts;
    };
    EXPECT_THAT(scores(15.0), testing::ElementsAre(2, 1, 1, 0));
    EXPECT_THAT(scores(80.0), testing::ElementsAre(0, 0, 0, 0));
}

TEST(Marks, KeepToTheLargestTextHeight) {
    FitParams fit;
    for (const double height : {1.2, 2.5, 4.0}) {
        fit.text_mm = height;
        double tallest = 0.0;
        for (const Piece& piece : marked(test::flat_grid({4, 6}, 30.0), fit).pieces) {
            for (const Mark& mark : piece.marks) {
                tallest = std::max(tallest, mark.height_mm);
            }
        }
        EXPECT_DOUBLE_EQ(tallest, height);
    }
}

TEST(Marks, ShortenTheLabelOfPiecesThatAreShort) {
    auto mesh = test::flat_grid({1, 2}, 10.0);
    for (Eigen::Vector3d& p : mesh.vertices) {
        p *= 0.28;  // W1 is 5.6 mm long and 2.4 wide, P1 and P2 2.8 long.
    }
    const Marked made = marked(mesh);
    std::set<std::string> texts;
    for (const Piece& piece : made.pieces) {
        expect_clean(piece);
        EXPECT_FALSE(piece.marks.empty());
        for (const Mark& mark : piece.marks) {
            texts.insert(mark.text);
        }
    }
    EXPECT_THAT(texts, testing::Contains("W1.1>"));
    EXPECT_THAT(texts, testing::Contains("2.1"));
    EXPECT_THAT(made.left_out.unnamed_strips, testing::IsEmpty());
}

TEST(Marks, TellOnceWhichStripsAreTooNarrowForAnyLabel) {
    FitParams fit;
    fit.weave_marks = false;
    const Marked narrow = marked(test::flat_grid({2, 4}, 1.5), fit);
    EXPECT_EQ(narrow.left_out.unnamed_strips.size(), narrow.strips.size());
    EXPECT_THAT(narrow.warnings,
                testing::ElementsAre(testing::HasSubstr("W1, W2, P1, P2, P3, P4")));
    fit.labels = false;
    EXPECT_THAT(marked(test::flat_grid({2, 4}, 1.5), fit).warnings, testing::IsEmpty());
}

TEST(Marks, KeepClearOfWhatAPieceHasAlready) {
    const auto mesh = test::flat_grid({2, 8}, 10.0);
    Marked made = marked(mesh);
    Piece& piece = made.pieces[0];
    piece.marks.clear();
    const Vector2d start = (piece.cut_left[0] + piece.cut_right[0]) / 2.0;
    const Vector2d end = (piece.cut_left[8] + piece.cut_right[8]) / 2.0;
    piece.cuts.push_back({start + 0.1 * (end - start), end - 0.1 * (end - start)});
    mark_pieces({&piece, 1}, made.strips, made.crossings, {}, made.warnings);
    expect_clean(piece);
    for (const Mark& mark : piece.marks) {
        for (const Polyline& stroke : strokes_of(mark)) {
            EXPECT_GT(distance(stroke, piece.cuts[0]), 0.04) << mark.text;
        }
    }
    const std::size_t before = piece.marks.size();
    FitParams none;
    none.labels = false;
    none.weave_marks = false;
    none.cell_marks = CellMarks::None;
    mark_pieces({&piece, 1}, made.strips, made.crossings, none, made.warnings);
    EXPECT_EQ(piece.marks.size(), before);
}

TEST(MarkLegend, ExplainsWhatIsMarked) {
    EXPECT_GE(mark_legend().size(), 8U);
    for (const LegendEntry& entry : mark_legend()) {
        EXPECT_FALSE(entry.symbol.empty());
        EXPECT_FALSE(entry.meaning.empty());
        EXPECT_FALSE(entry.picture.empty());
        EXPECT_EQ(entry.meaning.find('\n'), std::string::npos);
    }
    FitParams bare;
    bare.labels = false;
    bare.weave_marks = false;
    bare.cell_marks = CellMarks::None;
    EXPECT_EQ(mark_legend(bare).size(), 2U);
}

}  // namespace
}  // namespace leafcutter::fab
