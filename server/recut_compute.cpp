#include "server/recut_compute.h"

#include <chrono>
#include <utility>

#include <nlohmann/json.hpp>

#include "server/material_json.h"
#include "server/recut.h"
#include "server/recut_wishes.h"
#include "server/weave_compute.h"

namespace leafcutter::server {

namespace {

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace

ComputeOutput recut_job_pieces(const RecutCall& call) {
    const RecutWishes wishes = wishes_from_json(nlohmann::json::parse(call.wishes_json));
    const std::vector<fab::Material> materials =
        with_materials(fab::built_in_materials(), materials_from_records(call.material_records));
    geometry::Context context;
    context.threads = 1;  // Beside the jobs in work.
    context.clock_s = steady_seconds;
    fab::RecutSummary summary =
        recut_package({call.job_name, call.read}, wishes, materials, context);
    const nlohmann::json text = {{"quads", 0},
                                 {"strips", 0},
                                 {"pieces", summary.pieces},
                                 {"sheets", summary.sheets},
                                 {"estimated_s", summary.estimated_s},
                                 {"warnings", nlohmann::json::array()}};
    ComputeOutput output;
    output.summary_json = text.dump();
    output.sheets = sheets_in(summary.package);
    output.package = std::move(summary.package);
    return output;
}

}  // namespace leafcutter::server
