#include <vector>

#include <nlohmann/json.hpp>

#include "fab/package/records.h"
#include "server/params.h"
#include "server/params_names.h"
#include "server/params_stock.h"

namespace leafcutter::server {

using nlohmann::json;

namespace {

json rows_cols_to_json(const geometry::RowsCols& counts) {
    json result = json::object();
    if (counts.rows) {
        result["rows"] = *counts.rows;
    }
    if (counts.cols) {
        result["cols"] = *counts.cols;
    }
    return result;
}

json grid_to_json(const geometry::GridOptions& grid) {
    json result = rows_cols_to_json(grid.all);
    result["strip_width_mm"] = grid.strip_width_mm;
    result["may_narrow"] = grid.may_narrow;
    result["cylinders"] = json::array();
    for (const geometry::RowsCols& counts : grid.per_cylinder) {
        result["cylinders"].push_back(rows_cols_to_json(counts));
    }
    result["spacing"] = name_of(kSpacings, grid.spacing);
    result["junctions"] = name_of(kJunctions, grid.junctions);
    result["parity"] = name_of(kParities, grid.parity);
    result["planar"] = name_of(kPlanarities, grid.planar);
    result["even_cells"] = grid.even_cells;
    result["half_sag_offset"] = grid.half_sag_offset;
    return result;
}

json loops_to_json(const std::vector<fab::LoopParams>& loops) {
    json result = json::array();
    for (const fab::LoopParams& loop : loops) {
        result.push_back(loop.number ? json(*loop.number) : json(loop.vertices));
    }
    return result;
}

json punctures_to_json(const fab::FoliationParams& foliation) {
    if (foliation.puncture != geometry::PunctureChoice::Given) {
        return name_of(kPunctureChoices, foliation.puncture);
    }
    json result = json::array();
    for (const fab::PunctureParams& puncture : foliation.punctures) {
        result.push_back({{"vertex", puncture.vertex}, {"radius_mm", puncture.radius_mm}});
    }
    return result;
}

json foliation_to_json(const fab::FoliationParams& foliation) {
    json result = {{"mode", name_of(kModes, foliation.mode)},
                   {"torus_rings", name_of(kTorusRings, foliation.torus_rings)},
                   {"pants", name_of(kPantsSources, foliation.pants)},
                   {"loops", foliation.loops},
                   {"forbid", foliation.forbid},
                   {"function", name_of(kSweepFunctions, foliation.function)},
                   {"sources", loops_to_json(foliation.sources)},
                   {"sinks", loops_to_json(foliation.sinks)},
                   {"punctures", punctures_to_json(foliation)},
                   {"singularities", json::array()},
                   {"components", name_of(kComponents, foliation.components)}};
    result["weights"] = foliation.weights ? json(*foliation.weights) : json("auto");
    for (const fab::PlaceParams& place : foliation.near) {
        result["singularities"].push_back(
            {{"near", place.vertex ? json(*place.vertex) : json(place.position)}});
    }
    if (foliation.corners) {
        result["corners"] = *foliation.corners;
    }
    if (foliation.poles) {
        result["poles"] = *foliation.poles;
    }
    return result;
}

void add_stock(const fab::NestingParams& nesting, json& result) {
    if (nesting.turns) {
        result["rotation"] = rotations_to_json(*nesting.turns);
    }
    for (const fab::PieceTurns& turns : nesting.piece_turns) {
        result["rotations"][turns.of] = rotations_to_json(turns.turns);
    }
    for (const fab::StockItem& item : nesting.stock) {
        const json record = fab::stock_record(item);
        result["stock"].push_back(record);
    }
}

}  // namespace

json params_to_json(const fab::JobParams& params) {
    json result;
    if (params.scale.longest_side_mm) {
        result["scale"]["longest_side_mm"] = *params.scale.longest_side_mm;
    } else {
        result["scale"]["units"] = "mm";
    }
    result["foliation"] = foliation_to_json(params.foliation);
    result["grid"] = grid_to_json(params.grid);
    if (params.weave.pattern == fab::WeavePattern::Matrix) {
        result["weave"]["pattern"] = params.weave.matrix;
    } else {
        result["weave"]["pattern"] = name_of(kPatterns, params.weave.pattern);
    }
    if (params.weave.max_float) {
        result["weave"]["max_float"] = *params.weave.max_float;
    }
    result["fit"] = {
        {"columns", name_of(kColumnRuns, params.fit.columns)},
        {"joint", name_of(kJoint, params.fit.joint)},
        {"clearance_mm", params.fit.clearance_auto ? json("auto") : json(params.fit.clearance_mm)},
        {"crimp", params.fit.crimp},
        {"tab_mm", params.fit.tab_mm},
        {"max_piece_mm", params.fit.max_piece_mm},
        {"labels", params.fit.labels},
        {"cell_marks", name_of(kCellMarks, params.fit.cell_marks)},
        {"weave_marks", params.fit.weave_marks},
        {"score_deg", params.fit.score_deg},
        {"text_mm", params.fit.text_mm}};
    result["material"] = {{"warp", params.material.warp}, {"weft", params.material.weft}};
    result["nesting"] = {{"time_s", params.nesting.time_s},
                         {"spacing_mm", params.nesting.spacing_mm},
                         {"margin_mm", params.nesting.margin_mm},
                         {"rotation", name_of(kRotations, params.nesting.rotation)},
                         {"only_stock", params.nesting.only_stock},
                         {"seed", params.nesting.seed}};
    add_stock(params.nesting, result["nesting"]);
    result["cut"] = {
        {"lead_in_mm", params.cut.lead_in_mm},
        {"over_cut_mm", params.cut.over_cut_mm ? json(*params.cut.over_cut_mm) : json("auto")},
        {"tabs", params.cut.tabs},
        {"tab_mm", params.cut.tab_mm},
        {"common_edges", params.cut.common_edges},
        {"heat", params.cut.heat}};
    result["output"] = {{"dialect", name_of(kDialects, params.output.dialect)},
                        {"device", params.output.device},
                        {"machine", params.output.machine},
                        {"paper", name_of(kPapers, params.output.paper)},
                        {"models", params.output.models}};
    return result;
}

}  // namespace leafcutter::server
