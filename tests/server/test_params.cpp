#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "server/params.h"

namespace leafcutter::server {
namespace {

using geometry::ErrorKind;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// The message with which `text` is refused; empty if it isn't.
std::string refusal(std::string_view text, ErrorKind kind = ErrorKind::BadOption) {
    try {
        params_from_json(parse_params_text(text));
    } catch (const geometry::Error& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        return error.what();
    }
    return {};
}

TEST(Params, KeepDefaultsForWhatIsAbsent) {
    const fab::JobParams params = params_from_json(parse_params_text("{}"));
    EXPECT_EQ(params.scale.longest_side_mm, 300.0);
    EXPECT_EQ(params.grid.strip_width_mm, 10.0);
    EXPECT_EQ(params.material.weft, "paper-160-yellow");
}

TEST(Params, TakeEveryKeyOfTheDocumentation) {
    const fab::JobParams params = params_from_json(parse_params_text(R"({
        "scale": {"units": "mm"},
        "foliation": {"mode": "disk", "pants": "reeb", "loops": [], "weights": "auto",
                      "corners": [3, 1, 4, 15], "function": "auto", "sources": [], "sinks": [],
                      "punctures": "auto", "singularities": [], "torus_rings": "short",
                      "forbid": [],
                      "components": "each"},
        "grid": {"strip_width_mm": 5, "rows": 7, "cols": 8, "cylinders": [{"rows": 3}, {"cols": 4}],
                 "spacing": "uniform", "junctions": "independent", "parity": "any",
                 "planar": "off", "even_cells": false},
        "weave": {"pattern": [[0, 1, 1], [1, 0, 0]]},
        "fit": {"columns": "through", "clearance_mm": 0, "crimp": false, "tab_mm": 0,
                "max_piece_mm": 500, "labels": false, "cell_marks": "lines",
                "joint": "slot", "weave_marks": false, "score_deg": 30, "text_mm": 2.5},
        "material": {"warp": "felt-1", "weft": "card-300"},
        "nesting": {"time_s": 2.5, "spacing_mm": 0, "margin_mm": 3, "rotation": "0,90,180,270",
                    "seed": 9},
        "cut": {"lead_in_mm": 2, "over_cut_mm": 0.5, "tabs": 2, "tab_mm": 0.8,
                "common_edges": true, "heat": 0.5},
        "output": {"dialect": "marlin", "device": "big one", "machine": "co2-40w"}})"));
    EXPECT_FALSE(params.scale.longest_side_mm);
    EXPECT_EQ(params.foliation.mode, geometry::FoliationMode::Disk);
    EXPECT_EQ(params.foliation.corners, (std::array<int, 4>{3, 1, 4, 15}));
    EXPECT_EQ(params.grid.all.rows, 7);
    EXPECT_EQ(params.grid.per_cylinder.at(1).cols, 4);
    EXPECT_EQ(params.grid.junctions, geometry::Junctions::Independent);
    EXPECT_EQ(params.weave.matrix, (std::vector<std::vector<int>>{{0, 1, 1}, {1, 0, 0}}));
    EXPECT_EQ(params.fit.columns, fab::ColumnRuns::Through);
    EXPECT_EQ(params.fit.cell_marks, fab::CellMarks::Lines);
    EXPECT_FALSE(params.fit.weave_marks);
    EXPECT_EQ(params.fit.score_deg, 30.0);
    EXPECT_EQ(params.fit.text_mm, 2.5);
    EXPECT_EQ(params.fit.joint, fab::Joint::Slot);
    EXPECT_EQ(params.nesting.rotation, fab::Rotation::Quarter);
    EXPECT_EQ(params.nesting.seed, 9U);
    EXPECT_EQ(params.cut.lead_in_mm, 2.0);
    EXPECT_EQ(params.cut.over_cut_mm, 0.5);
    EXPECT_EQ(params.cut.tabs, 2);
    EXPECT_EQ(params.cut.tab_mm, 0.8);
    EXPECT_TRUE(params.cut.common_edges);
    EXPECT_EQ(params.cut.heat, 0.5);
    EXPECT_EQ(params.output.dialect, fab::Dialect::Marlin);
    EXPECT_EQ(params.output.machine, "co2-40w");
}

TEST(Params, CutsAreRefusedByFullPath) {
    EXPECT_EQ(refusal(R"({"cut": {"lead_in_mm": -1}})"), "cut.lead_in_mm: must be >= 0");
    EXPECT_EQ(refusal(R"({"cut": {"over_cut_mm": "some"}})"),
              "cut.over_cut_mm: must be a number or auto");
    EXPECT_EQ(refusal(R"({"cut": {"tabs": 1.5}})"), "cut.tabs: must be a whole number");
    EXPECT_THAT(refusal(R"({"cut": {"tab_mm": 0}})"), StartsWith("cut.tab_mm: must be"));
    EXPECT_THAT(refusal(R"({"cut": {"heat": 2}})"), StartsWith("cut.heat: must be"));
    EXPECT_EQ(refusal(R"({"cut": {"common_edges": true}})"),
              "cut.common_edges: needs pieces a kerf apart: set nesting.spacing_mm to 0");
    EXPECT_EQ(refusal(R"({"cut": {"common_edges": true}, "nesting": {"spacing_mm": 0}})"), "");
    EXPECT_EQ(refusal(R"({"cut": {"speed": 1}})"), "cut.speed: unknown key");
}

TEST(Params, LeaveTheOverCutToTheMaterial) {
    const fab::JobParams params =
        params_from_json(parse_params_text(R"({"cut": {"over_cut_mm": "auto"}})"));
    EXPECT_FALSE(params.cut.over_cut_mm);
    EXPECT_EQ(params_to_json(params)["cut"]["over_cut_mm"], "auto");
}

TEST(Params, ComeBackFromTheirJson) {
    const auto json = parse_params_text(R"({"scale": {"longest_side_mm": 120.5},
        "foliation": {"corners": [0, 5, 7, 9]}, "grid": {"rows": 4, "cylinders": [{"cols": 6}]},
        "weave": {"pattern": "satin-5", "max_float": 6}, "nesting": {"seed": 77}})");
    const auto whole = params_to_json(params_from_json(json));
    EXPECT_EQ(params_to_json(params_from_json(whole)), whole);
    EXPECT_EQ(whole["weave"]["pattern"], "satin-5");
    EXPECT_EQ(whole["weave"]["max_float"], 6);
    EXPECT_EQ(whole["grid"]["rows"], 4);
    EXPECT_EQ(whole["foliation"]["corners"], (nlohmann::json{0, 5, 7, 9}));
}

TEST(Params, TakeAClearanceThatThicknessDecides) {
    const fab::JobParams params = params_from_json(
        parse_params_text(R"({"fit": {"clearance_mm": "auto"}, "output": {"models": false}})"));
    EXPECT_TRUE(params.fit.clearance_auto);
    EXPECT_FALSE(params.output.models);
    EXPECT_EQ(params_to_json(params)["fit"]["clearance_mm"], "auto");
    EXPECT_EQ(params_to_json(params)["output"]["models"], false);
    EXPECT_EQ(refusal(R"({"fit": {"clearance_mm": "wide"}})"),
              "fit.clearance_mm: must be a number or auto");
    EXPECT_EQ(refusal(R"({"fit": {"clearance_mm": true}})"), "fit.clearance_mm: must be a number");
}

TEST(Params, RefuseUnknownKeysByFullPath) {
    EXPECT_EQ(refusal(R"({"colour": 1})"), "colour: unknown key");
    EXPECT_EQ(refusal(R"({"grid": {"width": 1}})"), "grid.width: unknown key");
    EXPECT_EQ(refusal(R"({"grid": {"cylinders": [{}, {"n": 1}]}})"),
              "grid.cylinders[1].n: unknown key");
}

TEST(Params, RefuseWrongTypesByFullPath) {
    EXPECT_EQ(refusal(R"([])"), "parameters: must be an object");
    EXPECT_EQ(refusal(R"({"grid": 5})"), "grid: must be an object");
    EXPECT_EQ(refusal(R"({"grid": {"strip_width_mm": "5"}})"),
              "grid.strip_width_mm: must be a number");
    EXPECT_EQ(refusal(R"({"grid": {"strip_width_mm": true}})"),
              "grid.strip_width_mm: must be a number");
    EXPECT_EQ(refusal(R"({"grid": {"rows": 2.5}})"), "grid.rows: must be a whole number");
    EXPECT_EQ(refusal(R"({"fit": {"crimp": 1}})"), "fit.crimp: must be true or false");
    EXPECT_EQ(refusal(R"({"material": {"warp": null}})"), "material.warp: must be text");
}

TEST(Params, RefuseImpossibleValuesByFullPath) {
    EXPECT_EQ(refusal(R"({"grid": {"strip_width_mm": 0}})"), "grid.strip_width_mm: must be > 0");
    EXPECT_EQ(refusal(R"({"grid": {"strip_width_mm": -1}})"), "grid.strip_width_mm: must be > 0");
    EXPECT_EQ(refusal(R"({"grid": {"rows": 0}})"), "grid.rows: must be >= 1");
    EXPECT_EQ(refusal(R"({"fit": {"tab_mm": -1}})"), "fit.tab_mm: must be >= 0");
    EXPECT_EQ(refusal(R"({"foliation": {"corners": [1, 2, 3, 3]}})"),
              "foliation.corners: must be four different vertices");
    EXPECT_EQ(refusal(R"({"foliation": {"corners": [1, 2, 3, -4]}})"),
              "foliation.corners[3]: must be >= 0");
    EXPECT_THAT(refusal(R"({"weave": {"pattern": "knit"}})"),
                StartsWith("weave.pattern: must be one of plain, twill-2x2"));
    EXPECT_THAT(refusal(R"({"weave": {"pattern": [[0, 1], [1]]}})"),
                StartsWith("weave.pattern[1]:"));
    EXPECT_THAT(refusal(R"({"weave": {"pattern": [[0, 2]]}})"), StartsWith("weave.pattern[0]:"));
    EXPECT_EQ(refusal(R"({"weave": {"max_float": 0}})"), "weave.max_float: must be >= 1");
    EXPECT_THAT(refusal(R"({"scale": {"units": "mm", "longest_side_mm": 3}})"),
                StartsWith("scale.units:"));
    EXPECT_THAT(refusal(R"({"nesting": {"seed": 99999999999}})"), StartsWith("nesting.seed:"));
}

TEST(Params, TakeAWholePantsSection) {
    const fab::FoliationParams foliation =
        params_from_json(parse_params_text(R"({"foliation": {"mode": "pants", "pants": "user",
            "loops": [[1, 2, 3], [9, 8, 7, 6]], "weights": [1, 2.5], "function": "fiedler",
            "punctures": [{"vertex": 5, "radius_mm": 2.5}], "components": "largest"}})"))
            .foliation;
    EXPECT_EQ(foliation.mode, geometry::FoliationMode::Pants);
    EXPECT_EQ(foliation.pants, geometry::PantsSource::User);
    EXPECT_EQ(foliation.loops, (std::vector<std::vector<int>>{{1, 2, 3}, {9, 8, 7, 6}}));
    EXPECT_EQ(foliation.weights, (std::vector<double>{1.0, 2.5}));
    EXPECT_EQ(foliation.function, geometry::SweepFunction::Fiedler);
    EXPECT_EQ(foliation.puncture, geometry::PunctureChoice::Given);
    ASSERT_EQ(foliation.punctures.size(), 1U);
    EXPECT_EQ(foliation.punctures[0].vertex, 5);
    EXPECT_EQ(foliation.punctures[0].radius_mm, 2.5);
    EXPECT_EQ(foliation.components, geometry::Components::Largest);
}

TEST(Params, TakeLoopsByNumberOrByTheirVertices) {
    const fab::FoliationParams foliation =
        params_from_json(parse_params_text(R"({"foliation": {"mode": "one-form",
            "sources": [0], "sinks": [[12, 13], 2]}})"))
            .foliation;
    ASSERT_EQ(foliation.sources.size(), 1U);
    EXPECT_EQ(foliation.sources[0].number, 0);
    ASSERT_EQ(foliation.sinks.size(), 2U);
    EXPECT_FALSE(foliation.sinks[0].number);
    EXPECT_EQ(foliation.sinks[0].vertices, (std::vector<int>{12, 13}));
    EXPECT_EQ(foliation.sinks[1].number, 2);
}

TEST(Params, OpenNoHolesForAnEmptyList) {
    const auto choice = [](const char* text) {
        return params_from_json(parse_params_text(text)).foliation.puncture;
    };
    EXPECT_EQ(choice(R"({"foliation": {"punctures": []}})"), geometry::PunctureChoice::None);
    EXPECT_EQ(choice(R"({"foliation": {"punctures": "none"}})"), geometry::PunctureChoice::None);
    EXPECT_EQ(choice("{}"), geometry::PunctureChoice::Auto);
}

TEST(Params, ComeBackFromTheirJsonInEveryMode) {
    for (const char* text :
         {R"({"mode": "pants", "pants": "user", "loops": [[1, 2, 3]], "weights": [0.5, 2]})",
          R"({"pants": "tunnel-loops", "function": "x", "components": "largest"})",
          R"({"mode": "one-form", "sources": [0, [4, 5]], "sinks": [1]})",
          R"({"mode": "sphere-polar", "poles": [3, 4], "punctures": "none"})",
          R"({"punctures": [{"vertex": 7, "radius_mm": 1.25}]})",
          R"({"mode": "sphere-pillowcase",
              "singularities": [{"near": 1}, {"near": 2}, {"near": 3}, {"near": 4}]})",
          R"({"mode": "pants", "forbid": [[4, 5, 6], [9, 8, 7]],
              "singularities": [{"near": [0.5, -2.0, 31.25]}, {"near": 12}]})",
          R"({"mode": "torus", "torus_rings": "long"})"}) {
        const auto given = nlohmann::json::parse(text);
        const auto whole = params_to_json(params_from_json({{"foliation", given}}));
        for (const auto& [key, value] : given.items()) {
            EXPECT_EQ(whole["foliation"][key], value) << text << " " << key;
        }
        EXPECT_EQ(params_to_json(params_from_json(whole)), whole) << text;
    }
}

TEST(Params, RefuseWrongFoliationValuesByFullPath) {
    const auto refused = [](const std::string& section) {
        return refusal(R"({"foliation": {)" + section + "}}");
    };
    EXPECT_THAT(refused(R"("mode": "cube")"), StartsWith("foliation.mode: must be one of auto, "));
    EXPECT_EQ(refused(R"("weights": [1, 0])"), "foliation.weights[1]: must be > 0");
    EXPECT_EQ(refused(R"("weights": [1, "2"])"), "foliation.weights[1]: must be a number");
    EXPECT_THAT(refused(R"("weights": [])"), StartsWith("foliation.weights: "));
    EXPECT_THAT(refused(R"("weights": 3)"), StartsWith("foliation.weights: must be auto or a "));
    EXPECT_THAT(refused(R"("pants": "user", "loops": [[1, 2, 3], [4, 4, 5]])"),
                StartsWith("foliation.loops[1]: must be three or more different vertices"));
    EXPECT_EQ(refused(R"("pants": "user", "loops": [[1, 2, -3]])"),
              "foliation.loops[0][2]: must be >= 0");
    EXPECT_THAT(refused(R"("mode": "one-form", "sources": ["wrist"])"),
                StartsWith("foliation.sources[0]: must be the number of a boundary loop or"));
    EXPECT_EQ(refused(R"("mode": "one-form", "sinks": [0, [1, 2.5]])"),
              "foliation.sinks[1][1]: must be a whole number");
    EXPECT_EQ(refused(R"("mode": "one-form", "sources": [1], "sinks": [0, 1])"),
              "foliation.sinks[1]: loop 1 is named already");
    EXPECT_EQ(refused(R"("punctures": [{"vertex": 1}])"),
              "foliation.punctures[0].radius_mm: must be given");
    EXPECT_EQ(refused(R"("punctures": [{"vertex": 1, "radius_mm": 0}])"),
              "foliation.punctures[0].radius_mm: must be > 0");
    EXPECT_EQ(refused(R"("punctures": [{"vertex": 1, "radius_mm": 1, "depth": 2}])"),
              "foliation.punctures[0].depth: unknown key");
    EXPECT_THAT(refused(R"("punctures": [{"vertex": 1, "radius_mm": 1},
                                         {"vertex": 1, "radius_mm": 2}])"),
                StartsWith("foliation.punctures[1].vertex: "));
    EXPECT_EQ(refused(R"("punctures": "some")"), "foliation.punctures: must be one of auto, none");
    EXPECT_EQ(refused(R"("mode": "sphere-polar", "poles": [1, 1])"),
              "foliation.poles: must be two different vertices");
    EXPECT_EQ(refused(R"("singularities": [{"near": 1}, {"near": 2}, {"near": 1}])"),
              "foliation.singularities[2].near: is wanted twice");
    EXPECT_THAT(refused(R"("singularities": [{"near": "top"}])"),
                StartsWith("foliation.singularities[0].near: must be a vertex, or a position"));
    EXPECT_THAT(refused(R"("singularities": [{"near": [1, 2]}])"),
                StartsWith("foliation.singularities[0].near: must be a vertex, or a position"));
    EXPECT_THAT(refused(R"("singularities": [{"near": [1, 2, "z"]}])"),
                StartsWith("foliation.singularities[0].near[2]: "));
    EXPECT_THAT(refused(R"("forbid": [[1, 2]])"),
                StartsWith("foliation.forbid[0]: must be three or more different vertices"));
    EXPECT_THAT(refused(R"("forbid": 7)"), StartsWith("foliation.forbid: must be a list of loops"));
    EXPECT_EQ(refused(R"("mode": "sphere-pillowcase", "singularities": [{}])"),
              "foliation.singularities[0].near: must be given");
}

TEST(Params, RefuseWhatCanMeanNothingTogether) {
    const auto refused = [](const std::string& section) {
        return refusal(R"({"foliation": {)" + section + "}}");
    };
    EXPECT_EQ(refused(R"("pants": "user")"),
              "foliation.loops: must be given with foliation.pants \"user\"");
    EXPECT_THAT(refused(R"("loops": [[1, 2, 3]])"), HasSubstr("set foliation.pants to \"user\""));
    EXPECT_EQ(refused(R"("poles": [1, 2])"),
              "foliation.poles: foliation.mode \"auto\" doesn't use it; set foliation.mode to "
              "\"sphere-polar\"");
    EXPECT_THAT(refused(R"("mode": "disk", "singularities": [{"near": 1}])"),
                StartsWith("foliation.singularities: foliation.mode \"disk\" doesn't use it"));
    EXPECT_EQ(refused(R"("mode": "sphere-polar", "poles": [1, 2], "singularities": [{"near": 1}])"),
              "foliation.singularities: not together with foliation.poles, which places them");
    EXPECT_THAT(refused(R"("mode": "one-form", "forbid": [[1, 2, 3]])"),
                HasSubstr("set foliation.mode to \"auto\" or \"pants\""));
    EXPECT_THAT(refused(R"("mode": "pants", "sources": [0])"), StartsWith("foliation.sources: "));
    EXPECT_THAT(refused(R"("sinks": [0])"), HasSubstr("\"one-form\""));
    EXPECT_THAT(refused(R"("mode": "disk", "pants": "tunnel-loops")"),
                StartsWith("foliation.pants: "));
    EXPECT_THAT(refused(R"("mode": "torus", "function": "z")"), StartsWith("foliation.function: "));
    EXPECT_THAT(refused(R"("mode": "annulus", "weights": [1])"), StartsWith("foliation.weights: "));
    EXPECT_THAT(refused(R"("mode": "pants", "corners": [1, 2, 3, 4])"),
                StartsWith("foliation.corners: "));
    EXPECT_THAT(refused(R"("mode": "pants", "torus_rings": "long")"),
                StartsWith("foliation.torus_rings: "));
    EXPECT_THAT(refused(R"("mode": "torus", "punctures": [{"vertex": 1, "radius_mm": 1}])"),
                StartsWith("foliation.punctures: "));
}

TEST(Params, TakeEvenCells) {
    const auto params = params_from_json(parse_params_text(R"({"grid": {"even_cells": true}})"));
    EXPECT_TRUE(params.grid.even_cells);
}

TEST(Params, TakeANameThatLooksLikeANumber) {
    nlohmann::json params;
    set_param(params, "nesting.rotation=0");
    EXPECT_EQ(params_from_json(params).nesting.rotation, fab::Rotation::Fixed);
}

TEST(Params, TakeStockOfAnyOutline) {
    const auto params = R"({"nesting": {"only_stock": true, "stock": [
        {"id": "board-1", "width_mm": 300, "height_mm": 200, "quantity": null, "cost": 2.5},
        {"id": "left", "material": "felt", "outline": [[10, 10], [90, 10], [60, 70]],
         "holes": [[[50, 20], [60, 20], [55, 30]]], "defects": [[[30, 15], [31, 15], [31, 16]]],
         "keep_out": [[[80, 10], [90, 10], [90, 12]]]}]}})"_json;
    const fab::JobParams read = params_from_json(params);
    ASSERT_EQ(read.nesting.stock.size(), 2U);
    EXPECT_FALSE(read.nesting.stock[0].quantity.has_value());
    const fab::StockItem& left = read.nesting.stock[1];
    EXPECT_EQ(left.quantity, 1);
    EXPECT_EQ(left.size.width_mm, 80.0);
    EXPECT_EQ(left.outline.front(), Eigen::Vector2d(0.0, 0.0));
    ASSERT_EQ(left.zones.size(), 3U);
    EXPECT_EQ(left.zones[0].outline.front(), Eigen::Vector2d(40.0, 10.0));
    EXPECT_EQ(left.zones[2].kind, fab::ZoneKind::KeepOut);
    EXPECT_EQ(params_to_json(params_from_json(params_to_json(read))), params_to_json(read));
}

TEST(Params, TakeRotationsAsIntervalsForEachPiece) {
    const auto params = R"({"nesting": {"rotation": [[-5, 5], 180],
        "rotations": {"W12": [0, 90], "warp": "free"}}})"_json;
    const fab::JobParams read = params_from_json(params);
    ASSERT_TRUE(read.nesting.turns.has_value());
    EXPECT_TRUE(read.nesting.turns->allows(3.0, 0.0));
    EXPECT_FALSE(read.nesting.turns->allows(177.0, 0.0));
    ASSERT_EQ(read.nesting.piece_turns.size(), 2U);
    EXPECT_TRUE(read.nesting.piece_turns[1].turns.empty());
    EXPECT_EQ(params_to_json(params_from_json(params_to_json(read))), params_to_json(read));
}

TEST(Params, RefuseWrongStockByFullPath) {
    const auto stock = [](const std::string& entry) {
        return refusal(R"({"nesting": {"stock": [)" + entry + "]}}");
    };
    EXPECT_THAT(stock("3"), StartsWith("nesting.stock[0]"));
    EXPECT_THAT(stock(R"({"width_mm": 10, "height_mm": 10})"), StartsWith("nesting.stock[0].id:"));
    EXPECT_THAT(stock(R"({"id": "a", "width_mm": 10})"), StartsWith("nesting.stock[0].width_mm:"));
    EXPECT_THAT(stock(R"({"id": "a", "width_mm": -1, "height_mm": 5})"),
                StartsWith("nesting.stock[0].width_mm:"));
    EXPECT_THAT(stock(R"({"id": "a", "width_mm": 1e308, "height_mm": 5})"),
                StartsWith("nesting.stock[0].width_mm:"));
    EXPECT_THAT(stock(R"({"id": "a", "outline": [[0, 0], [9, 9], [9, 0], [0, 9]]})"),
                StartsWith("nesting.stock[0].outline:"));
    EXPECT_THAT(stock(R"({"id": "a", "width_mm": 9, "height_mm": 9, "holes": [[[0, 0], [1, 1]]]})"),
                StartsWith("nesting.stock[0].holes[0]:"));
    EXPECT_THAT(stock(R"({"id": "a", "width_mm": 9, "height_mm": 9, "quantity": -1})"),
                StartsWith("nesting.stock[0].quantity:"));
    EXPECT_THAT(stock(R"({"id": "a", "width_mm": 9, "height_mm": 9, "quantity": null})"),
                StartsWith("nesting.stock[0].cost:"));
    EXPECT_THAT(stock(R"({"id": "a", "width_mm": 9, "height_mm": 9},
                         {"id": "a", "width_mm": 9, "height_mm": 9})"),
                StartsWith("nesting.stock[1].id:"));
    EXPECT_THAT(refusal(R"({"nesting": {"only_stock": true}})"), StartsWith("nesting.only_stock:"));
    EXPECT_THAT(refusal(R"({"nesting": {"rotation": [[5, -5]]}})"),
                StartsWith("nesting.rotation[0]:"));
    EXPECT_THAT(refusal(R"({"nesting": {"rotations": {"W1": "sideways"}}})"),
                StartsWith("nesting.rotations.W1:"));
}

TEST(ParseParams, RefusesWhatIsNoJson) {
    EXPECT_THAT(refusal("{"), StartsWith("parameters: no JSON: "));
    EXPECT_THAT(refusal(""), StartsWith("parameters: no JSON: "));
    EXPECT_THAT(refusal("{\"a\": 1e999}"), StartsWith("parameters: no JSON: "));
    EXPECT_EQ(refusal(R"({"grid": {"rows": 1, "rows": 2}})"), "rows: there twice");
    EXPECT_EQ(refusal(std::string(1000, '[')), "parameters: nested too deeply");
}

TEST(SetParam, SetsOneValueAndKeepsTheOthers) {
    auto params = parse_params_text(R"({"grid": {"parity": "any"}})");
    set_param(params, "grid.strip_width_mm=2.5");
    set_param(params, "material.warp=felt-1");
    set_param(params, "weave.pattern=[[1,0],[0,1]]");
    const fab::JobParams typed = params_from_json(params);
    EXPECT_EQ(typed.grid.strip_width_mm, 2.5);
    EXPECT_EQ(typed.grid.parity, geometry::Parity::Any);
    EXPECT_EQ(typed.material.warp, "felt-1");
    EXPECT_EQ(typed.weave.pattern, fab::WeavePattern::Matrix);
}

TEST(SetParam, RefusesAssignmentsWithoutPathOrValue) {
    for (const char* text : {"grid", "=3", "grid..rows=3", ".rows=3", "grid.=3", "grid.rows.x=1"}) {
        auto params = parse_params_text(R"({"grid": {"rows": 1}})");
        EXPECT_THROW(set_param(params, text), geometry::Error) << text;
    }
}

TEST(SetParam, TakesWhatIsNoJsonAsText) {
    auto params = parse_params_text("{}");
    set_param(params, "output.device=0x7");
    EXPECT_EQ(params_from_json(params).output.device, "0x7");
    set_param(params, "nesting.rotation=0,180");
    EXPECT_EQ(params_from_json(params).nesting.rotation, fab::Rotation::Half);
}

}  // namespace
}  // namespace leafcutter::server
