#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <polyclipping/clipper.hpp>

#include "fab/nest/check.h"
#include "fab/nest/collision.h"
#include "fab/nest/nest.h"
#include "fab/nest/shape.h"
#include "geometry/error.h"

namespace leafcutter::fab {
namespace {

// A band of constant width along an arc or an S, like an unfolded strip.
struct Band {
    double length_mm = 200.0;
    double width_mm = 10.0;
    double turn_rad = 1.0;
    bool s_shaped = false;
};

Piece band_piece(const std::string& id, const Band& band) {
    constexpr int kCells = 24;
    Piece piece;
    piece.id = id;
    Ring back;
    Eigen::Vector2d at(17.0, -5.0);
    double heading = 0.4;
    for (int i = 0; i <= kCells; ++i) {
        const Eigen::Vector2d side(-std::sin(heading), std::cos(heading));
        piece.outline.push_back(at - side * band.width_mm / 2.0);
        back.push_back(at + side * band.width_mm / 2.0);
        const double sign = band.s_shaped && i >= kCells / 2 ? -1.0 : 1.0;
        at += band.length_mm / kCells * Eigen::Vector2d(std::cos(heading), std::sin(heading));
        heading += sign * band.turn_rad / kCells;
    }
    piece.outline.insert(piece.outline.end(), back.rbegin(), back.rend());
    return piece;
}

// A lens: two arcs that meet in sharp tips.
Piece lens_piece(const std::string& id, double length_mm, double width_mm) {
    constexpr int kSteps = 16;
    Piece piece;
    piece.id = id;
    for (int i = 0; i < 2 * kSteps; ++i) {
        const double t = std::numbers::pi * i / kSteps;
        piece.outline.emplace_back(length_mm / 2.0 * std::cos(t),
                                   width_mm / 2.0 * std::pow(std::sin(t), 3));
    }
    return piece;
}

std::vector<Piece> random_bands(int count, std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto between = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
    };
    std::vector<Piece> pieces;
    for (int i = 0; i < count; ++i) {
        const std::string id = fmt::format("W{}.1", i + 1);
        if (i % 7 == 6) {
            pieces.push_back(lens_piece(id, between(40.0, 200.0), between(3.0, 14.0)));
        } else {
            pieces.push_back(band_piece(
                id, {between(50.0, 480.0), between(3.0, 16.0), between(0.0, 3.0), i % 3 == 0}));
        }
    }
    return pieces;
}

std::vector<const Piece*> pointers(const std::vector<Piece>& pieces) {
    std::vector<const Piece*> out;
    for (const Piece& piece : pieces) {
        out.push_back(&piece);
    }
    return out;
}

ClipperLib::Path units(const Ring& ring) {
    ClipperLib::Path path;
    for (const Eigen::Vector2d& point : ring) {
        path.emplace_back(std::llround(point.x() * 1e6), std::llround(point.y() * 1e6));
    }
    return path;
}

Ring placed(const Piece& piece, const Placement& placement) {
    Ring ring;
    for (const Eigen::Vector2d& point : piece.outline) {
        ring.push_back(placement.apply(point));
    }
    return ring;
}

const Piece& named(const std::vector<Piece>& pieces, const std::string& id) {
    for (const Piece& piece : pieces) {
        if (piece.id == id) {
            return piece;
        }
    }
    throw std::out_of_range(id);
}

// Area that two or more outlines of a sheet share, each grown by `grow_mm`: by Clipper, which the
// nesting itself doesn't use.
double shared_area_mm2(const Sheet& sheet, const std::vector<Piece>& pieces, double grow_mm) {
    double sum = 0.0;
    ClipperLib::Clipper clipper;
    for (const Placement& placement : sheet.placements) {
        ClipperLib::ClipperOffset offset(2.0, 1e2);
        offset.AddPath(units(placed(named(pieces, placement.piece), placement)),
                       ClipperLib::jtRound, ClipperLib::etClosedPolygon);
        ClipperLib::Paths grown;
        offset.Execute(grown, grow_mm * 1e6);
        for (const ClipperLib::Path& path : grown) {
            sum += ClipperLib::Area(path);
        }
        clipper.AddPaths(grown, ClipperLib::ptSubject, true);
    }
    ClipperLib::Paths together;
    clipper.Execute(ClipperLib::ctUnion, together, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
    double whole = 0.0;
    for (const ClipperLib::Path& path : together) {
        whole += ClipperLib::Area(path);
    }
    return (sum - whole) / 1e12;
}

void expect_same(const Layout& a, const Layout& b) {
    ASSERT_EQ(a.sheets.size(), b.sheets.size());
    for (std::size_t s = 0; s < a.sheets.size(); ++s) {
        ASSERT_EQ(a.sheets[s].placements.size(), b.sheets[s].placements.size());
        for (std::size_t i = 0; i < a.sheets[s].placements.size(); ++i) {
            EXPECT_EQ(a.sheets[s].placements[i].piece, b.sheets[s].placements[i].piece);
            EXPECT_EQ(a.sheets[s].placements[i].x_mm, b.sheets[s].placements[i].x_mm);
            EXPECT_EQ(a.sheets[s].placements[i].y_mm, b.sheets[s].placements[i].y_mm);
            EXPECT_EQ(a.sheets[s].placements[i].rotation_deg,
                      b.sheets[s].placements[i].rotation_deg);
        }
    }
}

constexpr SheetSize kSheet{600.0, 400.0};

TEST(Nest, PlacesEveryPieceOnceClearOfTheOthersAndOfTheMargin) {
    const std::vector<Piece> pieces = random_bands(80, 3);
    NestOptions options;
    options.kerf_mm = 0.15;
    options.max_evaluations = 1;
    const Layout layout = nest(pointers(pieces), kSheet, options);

    std::set<std::string> seen;
    for (const Sheet& sheet : layout.sheets) {
        // Grown by a hair less than half the gap, no two may share any area.
        EXPECT_NEAR(shared_area_mm2(sheet, pieces, (1.0 + 0.15) / 2.0 - 1e-3), 0.0, 1e-6);
        for (const Placement& placement : sheet.placements) {
            EXPECT_TRUE(seen.insert(placement.piece).second) << placement.piece;
            EXPECT_FALSE(placement.mirrored);
            for (const Eigen::Vector2d& point : placed(named(pieces, placement.piece), placement)) {
                EXPECT_GE(point.minCoeff(), 5.075 - 1e-9);
                EXPECT_LE(point.x(), 594.925 + 1e-9);
                EXPECT_LE(point.y(), 394.925 + 1e-9);
            }
        }
    }
    EXPECT_EQ(seen.size(), pieces.size());
    EXPECT_TRUE(layout.unplaced.empty());
    EXPECT_GE(layout.smallest_gap_mm, 1.15);
    EXPECT_LT(layout.smallest_gap_mm, 1.16) << "pieces should touch at the gap";
}

TEST(Nest, GivesTheSameLayoutForTheSameSeed) {
    const std::vector<Piece> pieces = random_bands(24, 8);
    NestOptions options;
    options.max_evaluations = 40'000;
    options.seed = 5;
    expect_same(nest(pointers(pieces), kSheet, options), nest(pointers(pieces), kSheet, options));
}

TEST(Nest, GivesTheSameLayoutOnOneThreadAndTwo) {
    const std::vector<Piece> pieces = random_bands(24, 9);
    NestOptions options;
    options.max_evaluations = 60'000;
    geometry::Context two;
    two.threads = 2;
    expect_same(nest(pointers(pieces), kSheet, options),
                nest(pointers(pieces), kSheet, options, two));
}

TEST(Nest, NamesThePieceThatCrossesItself) {
    std::vector<Piece> pieces = random_bands(3, 1);
    pieces[1].outline = {{0.0, 0.0}, {40.0, 0.0}, {10.0, 30.0}, {20.0, -10.0}};
    try {
        nest(pointers(pieces), kSheet, {});
        FAIL();
    } catch (const geometry::Error& error) {
        EXPECT_NE(std::string(error.what()).find("piece W2.1"), std::string::npos);
    }
}

TEST(Nest, NeverGetsWorseWithMoreEvaluations) {
    const std::vector<Piece> pieces = random_bands(60, 11);
    NestOptions options;
    options.max_evaluations = 1;
    const Layout quick = nest(pointers(pieces), kSheet, options);
    options.max_evaluations = 200'000;
    const Layout slow = nest(pointers(pieces), kSheet, options);
    EXPECT_LE(slow.sheets.size(), quick.sheets.size());
}

TEST(Nest, StacksEqualArcsIntoEachOther) {
    std::vector<Piece> pieces;
    for (int i = 0; i < 24; ++i) {
        pieces.push_back(band_piece(fmt::format("W{}", i), {420.0, 9.0, 1.2, false}));
    }
    NestOptions options;
    options.max_evaluations = 20'000;
    const Layout layout = nest(pointers(pieces), kSheet, options);
    // Bounds of about 400 x 70 mm: side by side, five would fill the sheet.
    EXPECT_EQ(layout.sheets.size(), 1U);
}

class NestRotations : public testing::TestWithParam<Rotation> {};

TEST_P(NestRotations, AreKeptTo) {
    const std::vector<Piece> pieces = random_bands(30, 21);
    NestOptions options;
    options.rotation = GetParam();
    options.max_evaluations = 30'000;
    const Layout layout = nest(pointers(pieces), kSheet, options);
    std::size_t placed_count = 0;
    for (const Sheet& sheet : layout.sheets) {
        for (const Placement& placement : sheet.placements) {
            ++placed_count;
            const double step = GetParam() == Rotation::Half      ? 180.0
                                : GetParam() == Rotation::Quarter ? 90.0
                                                                  : 360.0;
            EXPECT_EQ(std::remainder(placement.rotation_deg, step), 0.0);
        }
    }
    EXPECT_EQ(placed_count + layout.unplaced.size(), pieces.size());
}

INSTANTIATE_TEST_SUITE_P(Sets,
                         NestRotations,
                         testing::Values(Rotation::Half, Rotation::Quarter, Rotation::Fixed));

TEST(Nest, ReportsWhatFitsNoSheet) {
    std::vector<Piece> pieces{band_piece("long", {900.0, 10.0, 0.0, false}),
                              band_piece("short", {100.0, 10.0, 0.0, false})};
    const Layout layout = nest(pointers(pieces), kSheet, {});
    EXPECT_EQ(layout.unplaced, std::vector<std::string>{"long"});
    ASSERT_EQ(layout.sheets.size(), 1U);
    EXPECT_EQ(layout.sheets[0].placements.size(), 1U);
}

TEST(Nest, LaysAPieceSlantedThatFitsNoOtherWay) {
    const std::vector<Piece> pieces{band_piece("slanted", {655.0, 8.0, 0.0, false})};
    const Layout layout = nest(pointers(pieces), kSheet, {});
    EXPECT_TRUE(layout.unplaced.empty());
    EXPECT_EQ(layout.sheets.size(), 1U);
}

TEST(Nest, RefusesASheetNoLargerThanItsMargins) {
    const std::vector<Piece> pieces = random_bands(1, 1);
    NestOptions options;
    options.margin_mm = 200.0;
    EXPECT_THROW(nest(pointers(pieces), kSheet, options), geometry::Error);
}

TEST(Nest, IsCancelledBeforeTheFirstLayout) {
    const std::vector<Piece> pieces = random_bands(10, 1);
    std::stop_source source;
    source.request_stop();
    geometry::Context context;
    context.stop = source.get_token();
    EXPECT_THROW(nest(pointers(pieces), kSheet, {}, context), geometry::Cancelled);
}

TEST(NestProof, SeesTwoPiecesTooCloseAndOneInsideAnother) {
    Piece large;
    large.id = "large";
    large.outline = {{0.0, 0.0}, {100.0, 0.0}, {100.0, 100.0}, {0.0, 100.0}};
    Piece small;
    small.id = "small";
    small.outline = {{0.0, 0.0}, {10.0, 0.0}, {10.0, 10.0}, {0.0, 10.0}};
    const std::vector<const Piece*> both{&large, &small};
    Layout layout;
    layout.sheets.push_back({1, "paper", "both", kSheet, {}, {{"large", 10.0, 10.0, 0.0, false}}});
    std::vector<Placement>& placements = layout.sheets[0].placements;

    placements.push_back({"small", 111.0, 50.0, 0.0, false});
    EXPECT_NEAR(prove_layout(layout, both, {}), 1.0, 1e-12);
    placements.back().x_mm = 110.5;
    EXPECT_THROW(prove_layout(layout, both, {}), geometry::Error);
    placements.back() = {"small", 50.0, 50.0, 0.0, false};
    EXPECT_THROW(prove_layout(layout, both, {}), geometry::Error);
    placements.back() = {"small", 2.0, 200.0, 0.0, false};
    EXPECT_THROW(prove_layout(layout, both, {}), geometry::Error) << "in the margin";
    placements.pop_back();
    EXPECT_THROW(prove_layout(layout, both, {}), geometry::Error) << "a piece left out";
}

TEST(PlacedOutlines, MeasureLikeAllPairsOfEdges) {
    std::mt19937 random(4);
    const std::vector<Piece> pieces = random_bands(12, 4);
    PlacedOutlines outlines({600.0, 400.0});
    std::vector<Ring> rings;
    for (const Piece& piece : pieces) {
        const Ring ring =
            moved(piece.outline, {static_cast<double>(random() % 360), {300.0, 200.0}});
        double expected = 1000.0;
        for (const Ring& other : rings) {
            for (std::size_t i = 0; i < ring.size(); ++i) {
                for (std::size_t j = 0; j < other.size(); ++j) {
                    const Segment a{ring[i], ring[(i + 1) % ring.size()]};
                    const Segment b{other[j], other[(j + 1) % other.size()]};
                    expected = std::min(expected, std::sqrt(squared_distance(a, b)));
                }
            }
        }
        EXPECT_NEAR(outlines.distance(ring, 1000.0), expected, 1e-9);
        rings.push_back(ring);
        outlines.add(ring);
    }
}

TEST(NestShape, LiesAlongItsLength) {
    const Piece piece = band_piece("W1.1", {300.0, 10.0, 0.0, false});
    const NestShape shape = make_shape(piece.outline);
    for (const double angle : shape.lying_deg) {
        const Eigen::Vector2d size = bounds(moved(piece.outline, {angle, {0.0, 0.0}})).size();
        EXPECT_NEAR(size.x(), 300.0, 1e-6);
        EXPECT_NEAR(size.y(), 10.0, 1e-6);
    }
    EXPECT_NEAR(shape.area_mm2, 3000.0, 1e-6);
}

}  // namespace
}  // namespace leafcutter::fab
