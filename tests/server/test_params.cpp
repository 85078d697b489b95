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
                      "punctures": "auto", "singularities": [], "torus_rings": "long"},
        "grid": {"strip_width_mm": 5, "rows": 7, "cols": 8, "cylinders": [{"rows": 3}, {"cols": 4}],
                 "spacing": "uniform", "junctions": "independent", "parity": "any",
                 "planar": "off", "even_cells": false},
        "weave": {"pattern": [[0, 1, 1], [1, 0, 0]]},
        "fit": {"columns": "through", "clearance_mm": 0, "crimp": false, "tab_mm": 0,
                "max_piece_mm": 500, "labels": false, "cell_marks": "lines"},
        "material": {"warp": "felt-1", "weft": "card-300"},
        "nesting": {"time_s": 2.5, "spacing_mm": 0, "margin_mm": 3, "rotation": "0,90,180,270",
                    "seed": 9},
        "output": {"dialect": "marlin", "device": "big one"}})"));
    EXPECT_FALSE(params.scale.longest_side_mm);
    EXPECT_EQ(params.foliation.mode, geometry::FoliationMode::Disk);
    EXPECT_EQ(params.foliation.corners, (std::array<int, 4>{3, 1, 4, 15}));
    EXPECT_EQ(params.foliation.torus_rings, geometry::TorusRings::Long);
    EXPECT_EQ(params.grid.all.rows, 7);
    EXPECT_EQ(params.grid.per_cylinder.at(1).cols, 4);
    EXPECT_EQ(params.grid.junctions, geometry::Junctions::Independent);
    EXPECT_EQ(params.weave.matrix, (std::vector<std::vector<int>>{{0, 1, 1}, {1, 0, 0}}));
    EXPECT_EQ(params.fit.columns, fab::ColumnRuns::Through);
    EXPECT_EQ(params.fit.cell_marks, fab::CellMarks::Lines);
    EXPECT_EQ(params.nesting.rotation, fab::Rotation::Quarter);
    EXPECT_EQ(params.nesting.seed, 9U);
    EXPECT_EQ(params.output.dialect, fab::Dialect::Marlin);
}

TEST(Params, ComeBackFromTheirJson) {
    const auto json = parse_params_text(R"({"scale": {"longest_side_mm": 120.5},
        "foliation": {"corners": [0, 5, 7, 9]}, "grid": {"rows": 4, "cylinders": [{"cols": 6}]},
        "weave": {"pattern": "satin-5"}, "nesting": {"seed": 77}})");
    const auto whole = params_to_json(params_from_json(json));
    EXPECT_EQ(params_to_json(params_from_json(whole)), whole);
    EXPECT_EQ(whole["weave"]["pattern"], "satin-5");
    EXPECT_EQ(whole["grid"]["rows"], 4);
    EXPECT_EQ(whole["foliation"]["corners"], (nlohmann::json{0, 5, 7, 9}));
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
    EXPECT_THAT(refusal(R"({"scale": {"units": "mm", "longest_side_mm": 3}})"),
                StartsWith("scale.units:"));
    EXPECT_THAT(refusal(R"({"nesting": {"seed": 99999999999}})"), StartsWith("nesting.seed:"));
}

TEST(Params, SayWhatIsNotComputedYet) {
    for (const char* text :
         {R"({"foliation": {"mode": "one-form"}})", R"({"foliation": {"mode": "sphere-polar"}})",
          R"({"foliation": {"pants": "user"}})", R"({"foliation": {"weights": [1, 2]}})",
          R"({"foliation": {"loops": [[1, 2, 3]]}})", R"({"foliation": {"poles": [1, 2]}})",
          R"({"foliation": {"punctures": [{"vertex": 1, "radius_mm": 2}]}})",
          R"({"foliation": {"singularities": [{"near": 3}]}})",
          R"({"foliation": {"function": "fiedler"}})", R"({"grid": {"planar": "full"}})",
          R"({"grid": {"even_cells": true}})"}) {
        EXPECT_THAT(refusal(text, ErrorKind::NotSupported), HasSubstr(": not supported yet: "))
            << text;
    }
}

TEST(Params, TakeANameThatLooksLikeANumber) {
    nlohmann::json params;
    set_param(params, "nesting.rotation=0");
    EXPECT_EQ(params_from_json(params).nesting.rotation, fab::Rotation::Fixed);
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
