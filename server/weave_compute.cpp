#include "server/weave_compute.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/pipeline.h"
#include "server/material_json.h"
#include "server/params.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

std::string summary_json(const fab::PackageSummary& summary) {
    const json text = {{"quads", summary.quads},
                       {"strips", summary.strips},
                       {"pieces", summary.pieces},
                       {"sheets", summary.sheets},
                       {"estimated_s", summary.estimated_s},
                       {"warnings", summary.warnings}};
    return text.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

std::vector<SheetPlan> sheets_in(const fab::Package& package) {
    std::vector<SheetPlan> sheets;
    const fab::PackageFile* report = package.find("report.json");
    if (report == nullptr) {
        return sheets;
    }
    const json parsed = json::parse(report->bytes);  // Outlives the loop over a part of it.
    for (const json& sheet : parsed.at("cut").at("sheets")) {
        SheetPlan plan;
        plan.number = sheet.at("sheet").get<int>();
        plan.material = sheet.at("material").get<std::string>();
        plan.estimated_s = sheet.at("estimated_s").get<double>();
        plan.program_path = fmt::format("sheets/sheet-{:03}.gcode", plan.number);
        sheets.push_back(std::move(plan));
    }
    return sheets;
}

ComputeOutput weave_job(const ComputeInput& input, const geometry::Context& context) {
    const fab::JobParams params = params_from_json(parse_params_text(input.params_json));
    const std::vector<fab::Material> materials =
        with_materials(fab::built_in_materials(), materials_from_records(input.material_records));
    fab::PipelineOptions options;
    options.materials = materials;
    options.params_json = params_to_json(params).dump();
    fab::PackageSummary summary =
        fab::weave({input.file_name, input.bytes}, params, options, context);
    ComputeOutput output;
    output.summary_json = summary_json(summary);
    output.sheets = sheets_in(summary.package);
    output.package = std::move(summary.package);
    return output;
}

void check_job_params(const std::string& params_json) {
    params_from_json(parse_params_text(params_json));
}

}  // namespace leafcutter::server
