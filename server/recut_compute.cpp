#include "server/recut_compute.h"

#include <utility>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "server/material_json.h"
#include "server/recut.h"
#include "server/recut_wishes.h"
#include "server/weave_compute.h"

namespace leafcutter::server {

namespace {

std::vector<fab::Material> materials_with(const std::vector<std::string>& records) {
    return with_materials(fab::built_in_materials(), materials_from_records(records));
}

std::string file_of(const ComputeInput& input, const std::string& path) {
    for (const fab::PackageFile& file : input.package) {
        if (file.path == path) {
            return file.bytes;
        }
    }
    throw geometry::Error(geometry::ErrorKind::BadFile, "bad-package",
                          "the package has no " + path);
}

}  // namespace

void check_job_recut(const RecutCall& call) {
    check_recut({call.job_name, call.read},
                wishes_from_json(nlohmann::json::parse(call.wishes_json)),
                materials_with(call.material_records));
}

ComputeOutput recut_job_pieces(const ComputeInput& input, const geometry::Context& context) {
    const RecutWishes wishes = wishes_from_json(nlohmann::json::parse(input.recut_json));
    const auto read = [&input](const std::string& path) { return file_of(input, path); };
    fab::RecutSummary summary = recut_package({input.job_name, read}, wishes,
                                              materials_with(input.material_records), context);
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
