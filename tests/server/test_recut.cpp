#include <filesystem>
#include <map>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "fab/nest/shape.h"
#include "fab/pipeline.h"
#include "geometry/error.h"
#include "geometry/io/mesh_writer.h"
#include "geometry/samples.h"
#include "server/package_reader.h"
#include "server/params.h"
#include "server/recut.h"
#include "server/recut_wishes.h"

namespace leafcutter::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

fab::Package woven() {
    const std::string mesh = geometry::write_obj(geometry::make_sample("torus", 800));
    const fab::JobParams params = params_from_json(parse_params_text(
        R"({"scale": {"longest_side_mm": 120}, "grid": {"strip_width_mm": 14},
            "material": {"weft": "card-300"}, "nesting": {"time_s": 0.05, "spacing_mm": 1.5},
            "output": {"machine": "co2-40w"}})"));
    const std::span<const char> letters(mesh.data(), mesh.size());
    return fab::weave({"torus.obj", std::as_bytes(letters)}, params,
                      {fab::built_in_materials(), {}, params_to_json(params).dump()}, {})
        .package;
}

// One for all tests: nothing here changes it.
const fab::Package& package() {
    static const fab::Package made = woven();
    return made;
}

PackageSource source(const fab::Package& of = package()) {
    return {"torus", [&of](const std::string& path) { return of.find(path)->bytes; }};
}

fab::RecutSummary recut(const RecutWishes& wishes, const fab::Package& of = package()) {
    return recut_package(source(of), wishes, fab::built_in_materials(), {});
}

std::string refusal(const RecutWishes& wishes, const fab::Package& of = package()) {
    try {
        recut(wishes, of);
    } catch (const geometry::Error& error) {
        return error.what();
    }
    return "done";
}

using Pieces = std::map<std::string, fab::Piece>;

Pieces pieces_in(const fab::Package& of) {
    Pieces pieces;
    for (fab::Piece& piece : read_pieces(of.find("strips.json")->bytes)) {
        pieces[piece.id] = std::move(piece);
    }
    return pieces;
}

std::vector<fab::Sheet> sheets_in(const fab::Package& of) {
    return read_sheets(of.find("layout.json")->bytes);
}

std::multiset<std::string> placed_in(const fab::Package& of) {
    std::multiset<std::string> placed;
    for (const fab::Sheet& sheet : sheets_in(of)) {
        for (const fab::Placement& placement : sheet.placements) {
            placed.insert(placement.piece);
        }
    }
    return placed;
}

TEST(Recut, OfAllPiecesIsTheSamePiecesBitByBit) {
    const fab::RecutSummary again = recut({.pieces = {"all"}});
    const Pieces before = pieces_in(package());
    const Pieces after = pieces_in(again.package);
    ASSERT_EQ(after.size(), before.size());
    for (const auto& [id, piece] : before) {
        EXPECT_EQ(after.at(id).outline, piece.outline) << id;
        EXPECT_EQ(after.at(id).family, piece.family) << id;
        ASSERT_EQ(after.at(id).marks.size(), piece.marks.size()) << id;
    }
    EXPECT_EQ(placed_in(again.package), placed_in(package()));
    EXPECT_EQ(again.pieces, static_cast<int>(before.size()));
    const auto old = nlohmann::json::parse(package().find("strips.json")->bytes);
    const auto fresh = nlohmann::json::parse(again.package.find("strips.json")->bytes);
    EXPECT_EQ(fresh, old);
}

TEST(Recut, CutsWithTheSettingsOfTheJob) {
    const fab::RecutSummary again = recut({.pieces = {"W1.1", "P1.1"}});
    const auto report = nlohmann::json::parse(again.package.find("report.json")->bytes);
    const auto whole = nlohmann::json::parse(package().find("report.json")->bytes);
    EXPECT_EQ(report.at("materials"), whole.at("materials"));
    EXPECT_EQ(report.at("params"), whole.at("params"));
    EXPECT_EQ(report.at("machine"), whole.at("machine"));
    const fab::Material card =
        fab::on_machine(*fab::find_material(fab::built_in_materials(), "card-300"), "co2-40w");
    EXPECT_EQ(report.at("materials")[0].at("kerf_mm"), card.kerf_mm);
    ASSERT_EQ(again.sheets, 2);  // One of each material.
    for (const char* ending : {"svg", "dxf", "gcode"}) {
        EXPECT_NE(again.package.find(std::string("sheets/sheet-002.") + ending), nullptr);
    }
    EXPECT_THAT(again.package.find("recut.html")->bytes, HasSubstr("<b>W1.1</b>"));
}

TEST(Recut, KnowsPiecesStripsAndSheets) {
    const auto strips = read_strips(package().find("strips.json")->bytes);
    const auto longest = std::max_element(
        strips.begin(), strips.end(),
        [](const fab::Strip& a, const fab::Strip& b) { return a.pieces.size() < b.pieces.size(); });
    EXPECT_EQ(placed_in(recut({.pieces = {longest->id}}).package),
              std::multiset<std::string>(longest->pieces.begin(), longest->pieces.end()));
    const fab::Sheet first = sheets_in(package()).front();
    std::multiset<std::string> on_first;
    for (const fab::Placement& placement : first.placements) {
        on_first.insert(placement.piece);
    }
    EXPECT_EQ(placed_in(recut({.pieces = {"sheet:1"}}).package), on_first);
    // Named twice, cut once.
    EXPECT_THAT(placed_in(recut({.pieces = {"W1.1", "W1.1"}}).package), ElementsAre("W1.1"));
}

TEST(Recut, NamesTheNearestOfWhatIsNotThere) {
    const std::string refused = refusal({.pieces = {"w1.l"}});
    EXPECT_THAT(refused, HasSubstr("torus: has no piece or strip w1.l"));
    EXPECT_THAT(refused, HasSubstr("W1.1"));
    EXPECT_THAT(refusal({.pieces = {"sheet:99"}}), HasSubstr("torus: has no sheet:99"));
    EXPECT_THAT(refusal({.pieces = {"sheet:x"}}), HasSubstr("torus: has no sheet:x"));
    EXPECT_THAT(refusal({.pieces = {"W1"}, .material = "tin"}), HasSubstr("there is no tin"));
}

TEST(Recut, UsesTheSheetItIsGivenOrRefuses) {
    const Pieces pieces = pieces_in(package());
    const Eigen::Vector2d size = fab::bounds(pieces.at("W1.1").outline).size();
    const fab::SheetSize room{size.x() + 12.0, size.y() + 12.0};
    const auto sheets = sheets_in(recut({.pieces = {"W1.1"}, .sheet = room}).package);
    ASSERT_EQ(sheets.size(), 1U);
    EXPECT_EQ(sheets[0].size.width_mm, room.width_mm);
    EXPECT_EQ(sheets[0].size.height_mm, room.height_mm);
    EXPECT_THAT(refusal({.pieces = {"W1.1"}, .sheet = fab::SheetSize{15.0, 15.0}}),
                HasSubstr("W1.1"));
}

TEST(Recut, LaysPiecesInsideARemnantOfAnyOutline) {
    // An L whose corner would hold pieces if its outline didn't count.
    const fab::Ring corner = {{50.0, 40.0},   {550.0, 40.0},  {550.0, 140.0},
                              {150.0, 140.0}, {150.0, 540.0}, {50.0, 540.0}};
    RecutWishes wishes;
    wishes.pieces = {"W1", "W2", "W3"};
    wishes.remnant = corner;
    const fab::Package made = recut(wishes).package;
    const auto sheets = sheets_in(made);
    ASSERT_EQ(sheets.size(), 1U);
    EXPECT_EQ(sheets[0].size.width_mm, 500.0);
    EXPECT_EQ(sheets[0].outline.size(), corner.size());
    EXPECT_EQ(sheets[0].material, "card-300");
    const Pieces pieces = pieces_in(made);
    constexpr double kMargin = 5.0;  // nesting.margin_mm, which leaves out the kerf.
    for (const fab::Placement& placement : sheets[0].placements) {
        for (const Eigen::Vector2d& corner_point : pieces.at(placement.piece).outline) {
            const Eigen::Vector2d p = placement.apply(corner_point);
            EXPECT_GT(p.x(), kMargin);
            EXPECT_GT(p.y(), kMargin);
            EXPECT_TRUE((p.x() < 100.0 - kMargin && p.y() < 500.0 - kMargin) ||
                        (p.y() < 100.0 - kMargin && p.x() < 500.0 - kMargin))
                << p.transpose();
        }
    }
}

TEST(Recut, RefusesRemnantsThatAreTooSmallOrOfTwoMaterials) {
    RecutWishes wishes;
    wishes.pieces = {"W1"};
    wishes.remnant = {{0.0, 0.0}, {30.0, 0.0}, {0.0, 30.0}};
    EXPECT_THAT(refusal(wishes), HasSubstr("no room on the remnant for W1."));
    wishes.remnant = {{0.0, 0.0}, {3.0, 0.0}, {0.0, 3.0}};
    EXPECT_THAT(refusal(wishes), HasSubstr("no larger than its margins"));
    wishes.remnant = {{0.0, 0.0}, {500.0, 0.0}, {500.0, 500.0}, {0.0, 500.0}};
    wishes.pieces = {"W1", "P1"};
    EXPECT_THAT(refusal(wishes), HasSubstr("a remnant is of one material"));
    wishes.material = "felt-1";
    EXPECT_EQ(refusal(wishes), "done");
}

TEST(Recut, CanBeCutAgainItself) {
    RecutWishes other;
    other.pieces = {"W1", "W2"};
    other.material = "felt-1";
    const fab::Package once = recut(other).package;
    const fab::Package twice = recut({.pieces = {"W2"}}, once).package;
    EXPECT_EQ(sheets_in(twice).front().material, "felt-1");
    EXPECT_EQ(pieces_in(twice).at("W2.1").outline, pieces_in(package()).at("W2.1").outline);
    EXPECT_THAT(refusal({.pieces = {"W3"}}, once), HasSubstr("has no piece or strip W3"));
}

TEST(Recut, OfAPackageThatDoesntSayHowItWasMadeIsRefused) {
    fab::Package old = package();
    for (fab::PackageFile& file : old.files) {
        if (file.path == "report.json") {
            auto report = nlohmann::json::parse(file.bytes);
            report.erase("params");
            file.bytes = report.dump();
        }
    }
    EXPECT_THAT(refusal({.pieces = {"W1"}}, old), HasSubstr("report.json: doesn't say how"));
}

TEST(RecutWishes, AreReadStrictly) {
    const auto refused = [](const char* text) {
        try {
            wishes_from_json(nlohmann::json::parse(text));
        } catch (const geometry::Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_THAT(refused(R"({})"), HasSubstr("pieces: must be a list"));
    EXPECT_THAT(refused(R"({"pieces": [1]})"), HasSubstr("pieces[0]: must be text"));
    EXPECT_THAT(refused(R"({"pieces": ["W1"], "sheets": 1})"), HasSubstr("sheets: unknown key"));
    EXPECT_THAT(refused(R"({"pieces": ["W1"], "sheet": {"width_mm": 5}})"),
                HasSubstr("sheet: must have"));
    EXPECT_THAT(refused(R"({"pieces": ["W1"], "remnant": [[0, 0], [1, 1], [2, 2]]})"),
                HasSubstr("remnant: "));
    EXPECT_THAT(refused(R"({"pieces": ["W1"], "remnant": [[0, 0], [9, 0], [0, 9], [0, 0]]})"),
                IsEmpty());
}

}  // namespace
}  // namespace leafcutter::server
