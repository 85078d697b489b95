#include "server/weave_compute.h"

#include <algorithm>

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

// What each sheet is cut from and what it leaves. The offcuts are the last entries of stock.json,
// in the order of their sheets.
void add_places(const fab::Package& package, std::vector<SheetPlan>& plans) {
    const fab::PackageFile* layout = package.find("layout.json");
    const fab::PackageFile* stock = package.find("stock.json");
    if (layout == nullptr) {
        return;
    }
    const json parsed = json::parse(layout->bytes);
    const json left = stock == nullptr ? json::object() : json::parse(stock->bytes);
    const json entries = left.value("stock", json::array());
    const json& sheets = parsed.at("sheets");
    const auto leaves = [](const json& sheet) { return sheet.count("offcut") != 0; };
    std::size_t offcuts =
        static_cast<std::size_t>(std::count_if(sheets.begin(), sheets.end(), leaves));
    for (std::size_t i = 0; i < sheets.size() && i < plans.size(); ++i) {
        const json& sheet = sheets[i];
        plans[i].size_mm = {sheet.at("width_mm").get<double>(),
                            sheet.at("height_mm").get<double>()};
        plans[i].stock = sheet.value("stock", "");
        if (leaves(sheet)) {
            if (offcuts <= entries.size()) {
                plans[i].offcut_json = entries[entries.size() - offcuts].dump();
            }
            --offcuts;
        }
    }
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
    add_places(package, sheets);
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
