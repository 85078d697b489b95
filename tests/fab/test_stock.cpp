// Jobs on a mix of sheets: what is taken, what it costs, what is left.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fab/nest/check.h"
#include "fab/nest/family_nest.h"
#include "fab/nest/free_rectangle.h"
#include "fab/nest/nest.h"
#include "fab/nest/offcut.h"
#include "fab/nest/shape.h"
#include "geometry/error.h"

namespace leafcutter::fab {
namespace {

Ring rectangle(double x, double y, double width, double height) {
    return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

std::vector<Piece> blocks(int count, double width, double height) {
    std::vector<Piece> pieces;
    for (int i = 0; i < count; ++i) {
        Piece piece;
        piece.id = fmt::format("W{}.1", i + 1);
        piece.strip = fmt::format("W{}", i + 1);
        piece.outline = rectangle(0.0, 0.0, width, height);
        pieces.push_back(std::move(piece));
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

struct Offer {
    double width_mm = 0.0;
    double height_mm = 0.0;
    double cost = 0.0;
    int quantity = 0;  // 0: as many as wanted.
};

std::vector<StockItem> stock_of(const std::vector<Offer>& offers) {
    std::vector<StockItem> stock;
    for (const Offer& offer : offers) {
        StockItem item;
        item.id = fmt::format("S{}", stock.size());
        item.size = {offer.width_mm, offer.height_mm};
        item.cost = offer.cost;
        item.quantity = offer.quantity > 0 ? std::optional(offer.quantity) : std::nullopt;
        stock.push_back(std::move(item));
    }
    return stock;
}

NestOptions tight(std::int64_t evaluations = 60'000) {
    NestOptions options;
    options.margin_mm = 0.0;
    options.spacing_mm = 0.0;
    options.rotation = Rotation::Quarter;
    options.max_evaluations = evaluations;
    return options;
}

double cost_of(const Layout& layout) {
    double cost = 0.0;
    for (const Sheet& sheet : layout.sheets) {
        cost += sheet.cost;
    }
    return cost;
}

TEST(Stock, TakesTheRemnantThatHoldsAllForNothing) {
    const std::vector<Piece> pieces = blocks(4, 40.0, 20.0);
    const Layout layout =
        nest(pointers(pieces), stock_of({{600.0, 400.0, 5.0, 0}, {100.0, 60.0, 0.0, 1}}), tight());
    ASSERT_EQ(layout.sheets.size(), 1U);
    EXPECT_EQ(layout.sheets[0].stock, "S1");
    EXPECT_TRUE(layout.unplaced.empty());
}

TEST(Stock, TakesTheCheapestMixOfSizes) {
    // Ten blocks of 50 x 50; three large sheets would cost 12, two and a small one 9.
    const std::vector<Piece> pieces = blocks(10, 49.0, 49.0);
    const Layout layout =
        nest(pointers(pieces), stock_of({{102.0, 102.0, 4.0, 0}, {102.0, 51.0, 2.5, 0}}), tight());
    EXPECT_TRUE(layout.unplaced.empty());
    EXPECT_DOUBLE_EQ(cost_of(layout), 10.5);
}

TEST(Stock, PrefersFewerSheetsOfEqualCost) {
    const std::vector<Piece> pieces = blocks(6, 49.0, 49.0);
    const Layout layout =
        nest(pointers(pieces), stock_of({{104.0, 52.0, 1.0, 9}, {104.0, 160.0, 1.0, 9}}), tight());
    EXPECT_EQ(layout.sheets.size(), 1U);
    EXPECT_EQ(layout.sheets[0].stock, "S1");
}

TEST(Stock, NeverTakesMoreThanThereIs) {
    const std::vector<Piece> pieces = blocks(9, 49.0, 49.0);
    const Layout layout = nest(pointers(pieces), stock_of({{102.0, 102.0, 1.0, 2}}), tight());
    EXPECT_EQ(layout.sheets.size(), 2U);
    EXPECT_EQ(layout.unplaced.size(), 1U);
}

TEST(Stock, LaysWhatFitsAndNamesTheRest) {
    std::vector<Piece> pieces = blocks(3, 30.0, 30.0);
    pieces[1].outline = rectangle(0.0, 0.0, 500.0, 20.0);
    const Layout layout = nest(pointers(pieces), stock_of({{100.0, 100.0, 1.0, 0}}), tight());
    EXPECT_EQ(layout.unplaced, std::vector<std::string>{"W2.1"});
    EXPECT_EQ(layout.sheets.size(), 1U);
    EXPECT_EQ(layout.sheets[0].placements.size(), 2U);
}

TEST(Stock, GoesAroundHolesDefectsAndClamps) {
    const std::vector<Piece> pieces = blocks(8, 40.0, 12.0);
    StockItem sheet;
    sheet.id = "R1";
    sheet.outline = {{10.0, 10.0}, {130.0, 10.0}, {150.0, 110.0}, {70.0, 90.0}, {10.0, 130.0}};
    sheet.zones = {{ZoneKind::Hole, rectangle(40.0, 40.0, 12.0, 12.0)},
                   {ZoneKind::Defect, rectangle(90.0, 30.0, 1.0, 40.0)},
                   {ZoneKind::KeepOut, rectangle(10.0, 10.0, 8.0, 8.0)}};
    move_to_origin(sheet);
    NestOptions options = tight();
    options.margin_mm = 3.0;
    options.spacing_mm = 1.0;
    options.kerf_mm = 0.2;
    const Layout layout = nest(pointers(pieces), {&sheet, 1}, options);
    ASSERT_EQ(layout.sheets.size(), 1U);
    EXPECT_GE(layout.sheets[0].placements.size(), 6U);
    EXPECT_NO_THROW(prove_layout(layout, pointers(pieces), options));
    Layout onto_the_defect = layout;
    Placement& first = onto_the_defect.sheets[0].placements[0];
    first.rotation_deg = 0.0;
    first.x_mm = 60.0;
    first.y_mm = 30.0;
    onto_the_defect.sheets[0].placements.resize(1);
    for (std::size_t i = 1; i < layout.sheets[0].placements.size(); ++i) {
        onto_the_defect.unplaced.push_back(layout.sheets[0].placements[i].piece);
    }
    EXPECT_THROW(prove_layout(onto_the_defect, pointers(pieces), options), geometry::Error);
}

// Where spacing is more than twice the margin, pieces that lean into a notch must not come too near
// to its inner corner.
TEST(Stock, KeepsTheMarginAtTheInnerCornersOfNotches) {
    std::vector<Piece> pieces = blocks(3, 28.0, 20.0);
    StockItem sheet;
    sheet.id = "star";
    sheet.outline = {{0.0, 0.0},   {100.0, 0.0}, {100.0, 60.0}, {52.0, 60.0},
                     {50.0, 22.0}, {48.0, 60.0}, {0.0, 60.0}};
    move_to_origin(sheet);
    NestOptions options = tight(4'000);
    options.rotation = Rotation::Free;
    options.spacing_mm = 3.0;
    for (std::uint32_t seed = 1; seed <= 30; ++seed) {
        options.seed = seed;
        Layout layout;
        ASSERT_NO_THROW(layout = nest(pointers(pieces), {&sheet, 1}, options)) << seed;
        EXPECT_NO_THROW(prove_layout(layout, pointers(pieces), options));
        EXPECT_FALSE(layout.sheets.empty());
    }
}

TEST(Stock, RefusesWhatIsNoSheetByItsName) {
    const std::vector<Piece> pieces = blocks(1, 10.0, 10.0);
    const auto refusal = [&](StockItem sheet) {
        sheet.id = "shelf-7";
        try {
            nest(pointers(pieces), {&sheet, 1}, NestOptions());
        } catch (const geometry::Error& error) {
            EXPECT_EQ(error.kind(), geometry::ErrorKind::BadOption);
            return std::string(error.what());
        }
        return std::string();
    };
    std::vector<StockItem> bad(6);
    bad[0].size = {std::nan(""), 10.0};
    bad[1].size = {9.0, 9.0};  // Its margins alone are 10.
    bad[2].size = {1e308, 100.0};
    bad[3].size = {100.0, 100.0};
    bad[3].outline = {{0.0, 0.0}, {100.0, 100.0}, {100.0, 0.0}, {0.0, 100.0}};
    bad[4].size = {100.0, 100.0};
    bad[4].zones = {{ZoneKind::Hole, {{1.0, 1.0}, {5.0, 5.0}}}};
    bad[5].size = {100.0, 100.0};
    bad[5].cost = -1.0;
    for (const StockItem& sheet : bad) {
        EXPECT_NE(refusal(sheet).find("shelf-7"), std::string::npos) << refusal(sheet);
    }
}

TEST(Stock, RefusesAPieceThatIsThereTwice) {
    std::vector<Piece> pieces = blocks(2, 10.0, 10.0);
    pieces[1].id = pieces[0].id;
    EXPECT_THROW(nest(pointers(pieces), SheetSize{100.0, 100.0}, tight()), geometry::Error);
}

TEST(Offcut, IsTheWholeRestOfASheet) {
    const std::vector<Piece> pieces = blocks(1, 50.0, 100.0);
    Layout layout = nest(pointers(pieces), SheetSize{200.0, 101.0}, tight());
    add_offcuts(layout, pointers(pieces), 0.2);
    ASSERT_TRUE(layout.sheets[0].offcut.has_value());
    const Offcut& offcut = *layout.sheets[0].offcut;
    EXPECT_NEAR(offcut.area_mm2, 150.0 * 101.0, 100.0);
    EXPECT_NEAR(offcut.rectangle.width_mm, 150.0, 1.0);
    EXPECT_NEAR(offcut.rectangle.height_mm, 101.0, 1e-3);
}

TEST(Offcut, GoesBackOntoTheTable) {
    const std::vector<Piece> pieces = blocks(7, 45.0, 30.0);
    Layout layout = nest(pointers(pieces), SheetSize{200.0, 150.0}, tight());
    add_offcuts(layout, pointers(pieces), 0.2);
    ASSERT_TRUE(layout.sheets[0].offcut.has_value());
    StockItem remnant;
    remnant.id = "left";
    remnant.outline = layout.sheets[0].offcut->outline;
    move_to_origin(remnant);
    const std::vector<Piece> next = blocks(4, 45.0, 30.0);
    const Layout second = nest(pointers(next), {&remnant, 1}, tight());
    EXPECT_TRUE(second.unplaced.empty());
}

TEST(Offcut, IsNoneWhereNothingUsefulIsLeft) {
    const std::vector<Piece> pieces = blocks(1, 95.0, 95.0);
    Layout layout = nest(pointers(pieces), SheetSize{100.0, 100.0}, tight());
    add_offcuts(layout, pointers(pieces), 0.2);
    EXPECT_FALSE(layout.sheets[0].offcut.has_value());
}

TEST(FreeRectangle, IsTheLargestBesideHoles) {
    const std::vector<Ring> rings = {rectangle(10.0, 20.0, 100.0, 60.0),
                                     rectangle(60.0, 40.0, 10.0, 10.0)};
    const FreeRectangle found = largest_rectangle_in(rings);
    EXPECT_NEAR(found.size.width_mm * found.size.height_mm, 50.0 * 60.0, 1.0);
    EXPECT_NEAR(found.corner.x(), 10.0, 1e-3);
}

TEST(FreeRectangle, OfATriangleIsHalfOfIt) {
    const std::vector<Ring> rings = {{{0.0, 0.0}, {100.0, 0.0}, {0.0, 80.0}}};
    const FreeRectangle found = largest_rectangle_in(rings);
    EXPECT_NEAR(found.size.width_mm * found.size.height_mm, 2000.0, 40.0);
}

TEST(FamilyNest, TakesStockOfItsOwnMaterialOnly) {
    Material weft;
    weft.id = "blue";
    weft.sheets = {{{300.0, 200.0}, std::nullopt}};
    Material warp = weft;
    warp.id = "red";
    std::vector<Piece> pieces = blocks(4, 40.0, 20.0);
    pieces[3].family = Family::Warp;
    NestingParams params;
    params.time_s = 0.01;
    params.stock = stock_of({{120.0, 90.0, 0.0, 1}});
    params.stock[0].material = "blue";
    const Layout layout = nest_families(pieces, {weft, warp}, params);
    ASSERT_EQ(layout.sheets.size(), 2U);
    EXPECT_EQ(layout.sheets[0].stock, "S0");
    EXPECT_EQ(layout.sheets[0].material, "blue");
    EXPECT_EQ(layout.sheets[1].stock, "");
    EXPECT_TRUE(layout.unplaced.empty());
}

TEST(FamilyNest, SharesOutStockThatSuitsBothMaterials) {
    Material weft;
    weft.id = "blue";
    weft.sheets = {{{300.0, 200.0}, std::nullopt}};
    Material warp = weft;
    warp.id = "red";
    std::vector<Piece> pieces = blocks(2, 40.0, 20.0);
    pieces[1].family = Family::Warp;
    NestingParams params;
    params.time_s = 0.01;
    params.stock = stock_of({{120.0, 90.0, 0.0, 1}});
    params.only_stock = true;
    const Layout layout = nest_families(pieces, {weft, warp}, params);
    ASSERT_EQ(layout.sheets.size(), 1U);
    EXPECT_EQ(layout.unplaced, std::vector<std::string>{"W2.1"});
}

TEST(FamilyNest, TurnsAPieceAsItsStripSays) {
    Material paper;
    paper.id = "paper";
    paper.sheets = {{{300.0, 200.0}, std::nullopt}};
    const std::vector<Piece> pieces = blocks(3, 40.0, 20.0);
    NestingParams params;
    params.time_s = 0.01;
    params.rotation = Rotation::Fixed;
    params.piece_turns = {{"W2", Rotations(std::vector<AngleInterval>{{40.0, 50.0}})}};
    const Layout layout = nest_families(pieces, {paper, paper}, params);
    for (const Placement& placement : layout.sheets.at(0).placements) {
        const bool second = placement.piece == "W2.1";
        EXPECT_NEAR(placement.rotation_deg, second ? 45.0 : 0.0, second ? 5.0 : 0.0);
    }
}

}  // namespace
}  // namespace leafcutter::fab
