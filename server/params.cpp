#include "server/params.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/json_reader.h"
#include "server/params_foliation.h"
#include "server/params_names.h"
#include "server/params_stock.h"

namespace leafcutter::server {

namespace {

using fab::JobParams;
using nlohmann::json;

constexpr Range kLength{0.0, kLargestLengthMm};
constexpr Range kCount{1.0, 100'000.0};

void read_scale(ObjectReader& reader, fab::ScaleParams& scale) {
    const json* units = reader.get("units");
    const json* side = reader.get("longest_side_mm");
    if (units != nullptr && side != nullptr) {
        refuse_param(reader.path_of("units"), "not together with longest_side_mm");
    }
    if (units != nullptr) {
        if (read_text(*units, reader.path_of("units")) != "mm") {
            refuse_param(reader.path_of("units"), "must be mm");
        }
        scale.longest_side_mm.reset();
    }
    if (side != nullptr) {
        scale.longest_side_mm =
            read_number(*side, reader.path_of("longest_side_mm"), kPositiveLength);
    }
}

geometry::RowsCols read_rows_cols(ObjectReader& reader) {
    geometry::RowsCols counts;
    if (const json* rows = reader.get("rows")) {
        counts.rows = read_integer(*rows, reader.path_of("rows"), kCount);
    }
    if (const json* cols = reader.get("cols")) {
        counts.cols = read_integer(*cols, reader.path_of("cols"), kCount);
    }
    return counts;
}

void read_grid(ObjectReader& reader, geometry::GridOptions& grid) {
    // A width that nobody asked for may be another.
    grid.may_narrow = grid.may_narrow && reader.get("strip_width_mm") == nullptr;
    reader.boolean("may_narrow", grid.may_narrow);
    reader.number("strip_width_mm", grid.strip_width_mm, kPositiveLength);
    grid.all = read_rows_cols(reader);
    if (const json* value = reader.get("cylinders")) {
        const std::string path = reader.path_of("cylinders");
        if (!value->is_array()) {
            refuse_param(path, "must be a list");
        }
        grid.per_cylinder.clear();
        for (std::size_t i = 0; i < value->size(); ++i) {
            ObjectReader cylinder((*value)[i], fmt::format("{}[{}]", path, i));
            grid.per_cylinder.push_back(read_rows_cols(cylinder));
            cylinder.finish();
        }
    }
    read_choice(reader, "spacing", grid.spacing, kSpacings);
    read_choice(reader, "junctions", grid.junctions, kJunctions);
    read_choice(reader, "parity", grid.parity, kParities);
    read_choice(reader, "planar", grid.planar, kPlanarities);
    reader.boolean("even_cells", grid.even_cells);
    reader.boolean("half_sag_offset", grid.half_sag_offset);
}

std::vector<std::vector<int>> read_matrix(const json& value, const std::string& path) {
    constexpr std::size_t kLargest = 64;
    if (!value.is_array() || value.empty() || value.size() > kLargest) {
        refuse_param(path, "must be a pattern's name or a matrix of 1 to 64 rows");
    }
    std::vector<std::vector<int>> matrix;
    for (std::size_t i = 0; i < value.size(); ++i) {
        const std::string row_path = fmt::format("{}[{}]", path, i);
        matrix.push_back(read_integers(value[i], row_path));
        const std::vector<int>& row = matrix.back();
        if (row.empty() || row.size() > kLargest || row.size() != matrix.front().size()) {
            refuse_param(row_path, "rows must be equally long, 1 to 64 entries");
        }
        if (std::any_of(row.begin(), row.end(), [](int entry) { return entry > 1; })) {
            refuse_param(row_path, "entries must be 0 or 1");
        }
    }
    return matrix;
}

void read_weave(ObjectReader& reader, fab::WeaveParams& weave) {
    const json* pattern = reader.get("pattern");
    if (pattern != nullptr && pattern->is_array()) {
        weave.matrix = read_matrix(*pattern, reader.path_of("pattern"));
        weave.pattern = fab::WeavePattern::Matrix;
    } else {
        read_choice(reader, "pattern", weave.pattern, kPatterns);
    }
    if (const json* most = reader.get("max_float")) {
        weave.max_float = read_integer(*most, reader.path_of("max_float"), kCount);
    }
}

void read_fit(ObjectReader& reader, fab::FitParams& fit) {
    read_choice(reader, "columns", fit.columns, kColumnRuns);
    read_choice(reader, "joint", fit.joint, kJoint);
    if (const json* clearance = reader.get("clearance_mm"); clearance && clearance->is_string()) {
        if (*clearance != "auto") {
            refuse_param(reader.path_of("clearance_mm"), "must be a number or auto");
        }
        fit.clearance_auto = true;
    } else {
        reader.number("clearance_mm", fit.clearance_mm, kLength);
    }
    reader.boolean("crimp", fit.crimp);
    reader.number("tab_mm", fit.tab_mm, kLength);
    reader.number("max_piece_mm", fit.max_piece_mm, {0.0, 20'000.0, true});
    reader.boolean("labels", fit.labels);
    read_choice(reader, "cell_marks", fit.cell_marks, kCellMarks);
    reader.boolean("weave_marks", fit.weave_marks);
    reader.number("score_deg", fit.score_deg, {0.0, 180.0});
    reader.number("text_mm", fit.text_mm, {1.0, 100.0});
}

void read_material(ObjectReader& reader, fab::MaterialParams& material) {
    reader.text("warp", material.warp);
    reader.text("weft", material.weft);
}

void read_nesting(ObjectReader& reader, fab::NestingParams& nesting) {
    reader.number("time_s", nesting.time_s, {0.0, 86'400.0, true});
    reader.number("spacing_mm", nesting.spacing_mm, kLength);
    reader.number("margin_mm", nesting.margin_mm, kLength);
    if (const json* turns = reader.get("rotation"); turns != nullptr && turns->is_array()) {
        nesting.turns = read_rotations(*turns, reader.path_of("rotation"));
    } else {
        read_choice(reader, "rotation", nesting.rotation, kRotations);
    }
    if (const json* rotations = reader.get("rotations")) {
        const std::string path = reader.path_of("rotations");
        if (!rotations->is_object()) {
            refuse_param(path, "must be an object: {\"W12\": [[-5, 5]], \"warp\": \"0,180\"}");
        }
        for (const auto& [name, turns] : rotations->items()) {
            nesting.piece_turns.push_back(
                {name, read_rotations(turns, fmt::format("{}.{}", path, name))});
        }
    }
    if (const json* stock = reader.get("stock")) {
        nesting.stock = read_stock(*stock, reader.path_of("stock"));
    }
    reader.boolean("only_stock", nesting.only_stock);
    if (nesting.only_stock && nesting.stock.empty()) {
        refuse_param(reader.path_of("only_stock"),
                     "needs nesting.stock: there is nothing to cut from");
    }
    int seed = static_cast<int>(nesting.seed);
    reader.integer("seed", seed, {});
    nesting.seed = static_cast<std::uint32_t>(seed);
}

void read_cut(ObjectReader& reader, fab::CutParams& cut) {
    reader.number("lead_in_mm", cut.lead_in_mm, {0.0, 20.0});
    if (const json* value = reader.get("over_cut_mm"); value != nullptr && value->is_string()) {
        if (*value != "auto") {
            refuse_param(reader.path_of("over_cut_mm"), "must be a number or auto");
        }
        cut.over_cut_mm.reset();
    } else if (value != nullptr) {
        cut.over_cut_mm = read_number(*value, reader.path_of("over_cut_mm"), {0.0, 20.0});
    }
    reader.integer("tabs", cut.tabs, {0.0, 100.0});
    reader.number("tab_mm", cut.tab_mm, {0.05, 5.0});
    reader.boolean("common_edges", cut.common_edges);
    reader.number("heat", cut.heat, {0.0, 1.0});
}

void read_output(ObjectReader& reader, fab::OutputParams& output) {
    read_choice(reader, "dialect", output.dialect, kDialects);
    reader.text("device", output.device);
    reader.text("machine", output.machine);
    read_choice(reader, "paper", output.paper, kPapers);
    reader.boolean("models", output.models);
}

}  // namespace

JobParams params_from_json(const json& params) {
    JobParams result;
    ObjectReader reader(params, "");
    reader.object("scale", [&](ObjectReader& part) { read_scale(part, result.scale); });
    reader.object("foliation", [&](ObjectReader& part) { read_foliation(part, result.foliation); });
    reader.object("grid", [&](ObjectReader& part) { read_grid(part, result.grid); });
    reader.object("weave", [&](ObjectReader& part) { read_weave(part, result.weave); });
    reader.object("fit", [&](ObjectReader& part) { read_fit(part, result.fit); });
    reader.object("material", [&](ObjectReader& part) { read_material(part, result.material); });
    reader.object("nesting", [&](ObjectReader& part) { read_nesting(part, result.nesting); });
    reader.object("cut", [&](ObjectReader& part) { read_cut(part, result.cut); });
    reader.object("output", [&](ObjectReader& part) { read_output(part, result.output); });
    reader.finish();
    if (result.cut.common_edges && result.nesting.spacing_mm != 0.0) {
        refuse_param("cut.common_edges", "needs pieces a kerf apart: set nesting.spacing_mm to 0");
    }
    return result;
}

}  // namespace leafcutter::server
