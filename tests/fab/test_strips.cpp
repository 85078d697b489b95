#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "fab/strips/labels.h"
#include "fab/strips/marks.h"
#include "fab/strips/notches.h"
#include "fab/strips/overlap.h"
#include "fab/strips/sheet_fit.h"
#include "fab/strips/strips.h"
#include "fab/weave/thickness.h"
#include "tests/support/quad_grids.h"

namespace leafcutter::fab {
namespace {

using Eigen::Vector2d;

const PieceLimits kLimits{.usable_sheet = {590.0, 390.0}};

struct Made {
    std::vector<Strip> strips;
    std::vector<Piece> pieces;
    std::vector<std::string> warnings;
};

Made make(const geometry::QuadMesh& mesh,
          const FitParams& fit,
          const PieceLimits& limits = kLimits) {
    Made made;
    made.strips = make_strips(mesh, ColumnRuns::PerCylinder);
    const Crossings crossings = crossings_of(made.strips, weave_cells(mesh, {}));
    JointMap joints(mesh);
    for (std::size_t i = 0; i < made.strips.size(); ++i) {
        const PieceRules rules{fit, limits, crossings[i], &joints};
        for (Piece& piece : make_pieces(made.strips[i], mesh, rules, made.warnings)) {
            made.pieces.push_back(std::move(piece));
        }
    }
    mark_pieces(made.pieces, made.strips, crossings, fit, made.warnings);
    return made;
}

double area(const Ring& ring) {
    double sum = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vector2d& p = ring[i];
        const Vector2d& q = ring[(i + 1) % ring.size()];
        sum += p.x() * q.y() - p.y() * q.x();
    }
    return sum / 2.0;
}

// Crossing edges by brute force, as a second opinion on is_simple.
bool crosses_itself(const Ring& ring) {
    const auto turn = [](const Vector2d& a, const Vector2d& b, const Vector2d& c) {
        return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
    };
    const std::size_t n = ring.size();
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 2; j < n; ++j) {
            const Vector2d &p = ring[i], &q = ring[(i + 1) % n], &r = ring[j],
                           &s = ring[(j + 1) % n];
            if ((j + 1) % n != i && turn(p, q, r) * turn(p, q, s) < 0.0 &&
                turn(r, s, p) * turn(r, s, q) < 0.0) {
                return true;
            }
        }
    }
    return false;
}

void expect_sound(const geometry::QuadMesh& mesh, const Made& made) {
    std::map<std::string, std::set<int>> cells;
    for (const Piece& piece : made.pieces) {
        EXPECT_TRUE(is_simple(piece.outline)) << piece.id;
        EXPECT_FALSE(crosses_itself(piece.outline)) << piece.id;
        EXPECT_GT(area(piece.outline), 0.0) << piece.id;
        EXPECT_EQ(piece.left.size(), static_cast<std::size_t>(piece.cell_count) + 1);
        EXPECT_EQ(piece.bend.size(), static_cast<std::size_t>(piece.cell_count));
        for (int i = 0; i < piece.cell_count; ++i) {
            EXPECT_TRUE(cells[piece.strip].insert(piece.first_cell + i).second);
        }
        const RingInterior inside(piece.outline);
        for (const Mark& mark : piece.marks) {
            const auto strokes =
                mark.text.empty() ? std::vector<Polyline>{mark.path} : mark_strokes(mark);
            for (const Polyline& stroke : strokes) {
                EXPECT_TRUE(inside.contains(stroke)) << piece.id << " " << mark.text;
            }
        }
    }
    std::array<std::size_t, 2> quads{};
    for (const Strip& strip : made.strips) {
        EXPECT_EQ(cells[strip.id].size(), strip.quads.size()) << strip.id;
        quads[strip.family == Family::Weft ? 0 : 1] += strip.quads.size();
    }
    EXPECT_EQ(quads[0], mesh.quads.size());
    EXPECT_EQ(quads[1], mesh.quads.size());
}

TEST(MakeStrips, NumbersWeftThenWarpFromOne) {
    const auto strips = make_strips(test::flat_grid({2, 3}, 10.0), ColumnRuns::PerCylinder);
    ASSERT_EQ(strips.size(), 5U);
    EXPECT_EQ(strips[0].id, "W1");
    EXPECT_EQ(strips[0].quads, (std::vector<int>{0, 1, 2}));
    EXPECT_EQ(strips[2].id, "P1");
    EXPECT_EQ(strips[2].quads, (std::vector<int>{0, 3}));
    EXPECT_FALSE(strips[0].closed);
}

TEST(MakePieces, TakesTheClearanceOffBothLongSides) {
    FitParams fit;
    fit.crimp = false;
    const Made made = make(test::flat_grid({3, 6}, 10.0), fit);
    for (const Piece& piece : made.pieces) {
        EXPECT_NEAR(area(piece.outline), 9.6 * 10.0 * piece.cell_count, 1e-3) << piece.id;
    }
}

TEST(MakePieces, LengthensCellsByTheirCrimp) {
    FitParams fit;
    const PieceLimits thick{.usable_sheet = {590.0, 390.0}, .thickness_mm = 1.0, .crossed_mm = 0.6};
    const auto mesh = test::flat_grid({3, 6}, 10.0);
    const std::vector<Strip> strips = make_strips(mesh, ColumnRuns::PerCylinder);
    const Crossings crossings = crossings_of(strips, weave_cells(mesh, {}));
    const Made made = make(mesh, fit, thick);
    const CrimpRule rule{.own_mm = 1.0, .crossed_mm = 0.6, .gap_mm = 0.4};
    for (std::size_t i = 0; i < made.pieces.size(); ++i) {
        const Piece& piece = made.pieces[i];
        const std::vector<double> lengths(static_cast<std::size_t>(piece.cell_count), 10.0);
        double length = 10.0 * piece.cell_count;
        for (const double extra : crimp_extra_mm(crossings[i], lengths, rule, false)) {
            EXPECT_LT(extra, 1.0);
            length += extra;
        }
        EXPECT_GT(length, 10.0 * piece.cell_count + 0.1);
        EXPECT_NEAR(area(piece.outline), 9.6 * length, 1e-3) << piece.id;
    }
}

TEST(MakePieces, NeverNarrowsBelowTheLeastWidth) {
    FitParams fit;
    fit.clearance_mm = 3.0;
    fit.crimp = false;
    const PieceLimits limits{.usable_sheet = {590.0, 390.0}, .min_width_mm = 8.0};
    const Made made = make(test::flat_grid({2, 4}, 10.0), fit, limits);
    for (const Piece& piece : made.pieces) {
        EXPECT_NEAR(area(piece.outline), 8.0 * 10.0 * piece.cell_count, 1e-3) << piece.id;
    }
}

TEST(MakePieces, OpensAClosedStripOnceWithATab) {
    FitParams fit;
    fit.crimp = false;
    fit.clearance_mm = 0.0;
    const Made made = make(test::cylinder_grid({5, 24}, 40.0, 50.0), fit);
    const double side = 2.0 * 40.0 * std::sin(std::numbers::pi / 24.0);
    std::set<int> openings;
    for (const Piece& piece : made.pieces) {
        if (piece.family == Family::Weft) {
            EXPECT_EQ(piece.cell_count, 24);
            openings.insert(piece.first_cell);
            Vector2d low = piece.outline[0];
            Vector2d high = low;
            for (const Vector2d& p : piece.outline) {
                low = low.cwiseMin(p);
                high = high.cwiseMax(p);
            }
            EXPECT_NEAR((high - low).x(), 24 * side + 8.0, 1e-3) << piece.id;
        }
    }
    EXPECT_GT(openings.size(), 1U) << "joints of neighbours lie in one line";
    expect_sound(test::cylinder_grid({5, 24}, 40.0, 50.0), made);
}

TEST(MakePieces, PartsWhatIsLongerThanTheLimit) {
    FitParams fit;
    fit.max_piece_mm = 120.0;
    const auto mesh = test::flat_grid({3, 40}, 10.0);
    const Made made = make(mesh, fit);
    for (const Piece& piece : made.pieces) {
        EXPECT_LE((piece.outline.front() - piece.outline[piece.outline.size() / 2]).norm(), 121.0);
    }
    EXPECT_EQ(made.strips[0].pieces.size(), 4U);
    expect_sound(mesh, made);
}

TEST(MakePieces, PartsWhatIsLongerThanTheSheet) {
    const PieceLimits small{.usable_sheet = {100.0, 60.0}};
    const auto mesh = test::torus_grid({60, 16}, 90.0, 25.0);
    const Made made = make(mesh, {}, small);
    for (const Piece& piece : made.pieces) {
        EXPECT_TRUE(fits_sheet(piece.outline, small.usable_sheet, small.rotation)) << piece.id;
    }
    expect_sound(mesh, made);
}

// A strip that winds around a cone's tip more than once when laid flat.
TEST(MakePieces, PartsASpiralBeforeItLiesOnItself) {
    const auto mesh =
        test::quad_grid({1, 120}, geometry::ChartShape::Rectangle, [](double g, double f) {
            const double angle = 6.0 * std::numbers::pi * g;
            const double r = 40.0 + 8.0 * f;
            return Eigen::Vector3d(r * std::cos(angle), -r * std::sin(angle), 0.05 * g);
        });
    const Made made = make(mesh, {});
    EXPECT_GE(made.strips[0].pieces.size(), 3U);
    EXPECT_LE(made.strips[0].pieces.size(), 4U);
    EXPECT_TRUE(std::any_of(made.warnings.begin(), made.warnings.end(), [](const std::string& w) {
        return w.find("lain on itself") != std::string::npos;
    }));
    expect_sound(mesh, made);
}

TEST(MakePieces, MakesSoundOutlinesOfThinAndBumpyCells) {
    for (unsigned seed = 1; seed <= 6; ++seed) {
        const auto mesh = test::bumpy_grid({10, 40}, 8.0, seed);
        expect_sound(mesh, make(mesh, {}));
    }
}

TEST(IsSimple, RefusesTouchingCrossingAndClockwiseRings) {
    const Ring square{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
    EXPECT_TRUE(is_simple(square));
    EXPECT_FALSE(is_simple(Ring(square.rbegin(), square.rend())));
    EXPECT_FALSE(is_simple({{0, 0}, {10, 10}, {10, 0}, {0, 10}}));
    EXPECT_FALSE(is_simple({{0, 0}, {10, 0}, {10, 10}, {5, 0}, {0, 10}}));
    EXPECT_FALSE(is_simple({{0, 0}, {10, 0}, {14, 0}, {10, 0}, {10, 10}, {0, 10}}));
    EXPECT_TRUE(is_simple({{0, 0}, {10, 0}, {10, 10}, {5, 1e-5}, {0, 10}}));
}

TEST(KeepsGap, SeesASlitNarrowerThanTheGap) {
    const auto comb = [](double slit) {
        return Ring{{0, 0},  {20, 0}, {20, 10}, {10 + slit, 10}, {10 + slit, 9},
                    {12, 5}, {8, 5},  {10, 9},  {10, 10},        {0, 10}};
    };
    EXPECT_TRUE(keeps_gap(snapped(comb(1.0)), 0.5));
    EXPECT_FALSE(keeps_gap(snapped(comb(0.3)), 0.5));
}

TEST(FitsSheet, TriesTheAllowedRotationsOnly) {
    const Ring bar{{0, 0}, {3, 0}, {3, 100}, {0, 100}};
    EXPECT_FALSE(fits_sheet(bar, {120.0, 20.0}, Rotation::Fixed));
    EXPECT_TRUE(fits_sheet(bar, {120.0, 20.0}, Rotation::Quarter));
    const double s = std::sqrt(0.5);
    Ring slanted;
    for (const Vector2d& p : bar) {
        slanted.emplace_back(s * (p.x() - p.y()), s * (p.x() + p.y()));
    }
    EXPECT_FALSE(fits_sheet(slanted, {120.0, 20.0}, Rotation::Quarter));
    EXPECT_TRUE(fits_sheet(slanted, {120.0, 20.0}, Rotation::Free));
}

TEST(Notches, ThatABeamCannotCutAreFilledAndNothingElseMoves) {
    const Ring plain{{0, 0}, {20, 0}, {20, 5}, {12, 5}, {12, 4}, {8, 4}, {8, 5}, {0, 5}};
    EXPECT_EQ(without_notches(plain, 0.1), plain);
    // A slit of 0.06 mm, 2 mm deep, and a wide one.
    const Ring slit{{0, 0},  {20, 0},   {20, 5},   {15, 5}, {15, 3}, {13, 3},
                    {13, 5}, {5.06, 5}, {5.03, 3}, {5, 5},  {0, 5}};
    const Ring filled = without_notches(slit, 0.1);
    EXPECT_TRUE(is_simple(filled));
    EXPECT_NEAR(area(filled), 20.0 * 5.0 - 4.0, 0.01);
    EXPECT_GT(area(filled), area(slit) + 0.03);
    EXPECT_NE(std::find(filled.begin(), filled.end(), Vector2d(13, 3)), filled.end());
    EXPECT_EQ(without_notches(slit, 0.0), slit);
}

}  // namespace
}  // namespace leafcutter::fab
