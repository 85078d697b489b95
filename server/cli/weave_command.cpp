// `leafcutter weave MODEL -o DIR [--params FILE] [--set a.b=VALUE …]`: the whole computation.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/pipeline.h"
#include "geometry/io/read_mesh.h"
#include "server/cli/command.h"
#include "server/cli/input_file.h"
#include "server/cli/interrupt.h"
#include "server/cli/material_options.h"
#include "server/cli/package_dir.h"
#include "server/cli/progress_line.h"
#include "server/params.h"
#include "server/params_stock.h"

namespace leafcutter::server {

namespace {

struct WeaveOptions {
    std::string model;
    std::string output;
    std::string params_file;
    std::string materials_file;
    std::string stock_file;
    std::vector<std::string> assignments;
};

fab::JobParams job_params(const WeaveOptions& options) {
    constexpr std::size_t kMostBytes = 16U << 20U;
    nlohmann::json params = nlohmann::json::object();
    if (!options.params_file.empty()) {
        const std::vector<std::byte> bytes = read_input_file(options.params_file, kMostBytes);
        params = parse_params_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    }
    for (const std::string& assignment : options.assignments) {
        set_param(params, assignment);
    }
    if (!options.stock_file.empty()) {
        const std::vector<std::byte> bytes = read_input_file(options.stock_file, kMostBytes);
        params["nesting"]["stock"] =
            stock_of_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    }
    return params_from_json(params);
}

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

fab::PackageSummary compute(const WeaveOptions& options,
                            const fab::JobParams& params,
                            const geometry::Context& context) {
    const std::vector<std::byte> bytes =
        read_input_file(options.model, geometry::ReadLimits().max_bytes);
    const std::string name = std::filesystem::path(options.model).filename().string();
    const std::vector<fab::Material> materials = wanted_materials(options.materials_file);
    const fab::PipelineOptions how{materials, {}, params_to_json(params).dump()};
    return fab::weave({name, bytes}, params, how, context);
}

void tell(const WeaveOptions& options,
          const fab::PackageSummary& summary,
          const CommonOptions& common) {
    if (common.json) {
        const nlohmann::json line = {
            {"done", options.output},       {"quads", summary.quads},
            {"strips", summary.strips},     {"pieces", summary.pieces},
            {"sheets", summary.sheets},     {"estimated_s", summary.estimated_s},
            {"warnings", summary.warnings},
        };
        fmt::print(stderr, "{}\n",
                   line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
        return;
    }
    if (isatty(STDERR_FILENO) == 0) {
        return;
    }
    for (const std::string& warning : summary.warnings) {
        fmt::print(stderr, "note: {}\n", warning);
    }
    fmt::print(stderr,
               "{}: {} cells, {} strips in {} pieces on {} sheets, about {:.0f} min to cut\n",
               options.output, summary.quads, summary.strips, summary.pieces, summary.sheets,
               summary.estimated_s / 60.0);
}

void run_weave(const WeaveOptions& options, const CommonOptions& common) {
    const fab::JobParams params = job_params(options);
    const PackageDir directory(options.output);
    const InterruptWatch interrupt;
    ProgressLine progress(common);
    geometry::Context context;
    context.stop = interrupt.token();
    context.threads = std::max(1U, std::thread::hardware_concurrency());
    context.clock_s = steady_seconds;
    context.progress = [&](std::string_view stage, double fraction) {
        progress.show(stage, fraction);
    };
    const fab::PackageSummary summary = compute(options, params, context);
    context.check();
    directory.write(summary.package);
    progress.clear();
    tell(options, summary, common);
}

}  // namespace

void add_weave_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* command =
        app.add_subcommand("weave", "The whole computation: writes a package of files to cut");
    const auto options = std::make_shared<WeaveOptions>();  // Lives as long as the callback.
    command->add_option("model", options->model, "A mesh: .stl .obj .off .ply")->required();
    command->add_option("-o,--output", options->output, "Directory to write")->required();
    command->add_option("--params", options->params_file, "Job parameters, a JSON file");
    command->add_option("--materials", options->materials_file,
                        "A JSON file with materials of your own");
    command->add_option("--stock", options->stock_file,
                        "Sheets and remnants to cut from first: the stock.json of another package");
    command
        ->add_option("--set", options->assignments,
                     "One job parameter: grid.strip_width_mm=5 (may be repeated)")
        ->allow_extra_args(false);
    command->callback([options, &common] { run_weave(*options, common); });
}

}  // namespace leafcutter::server
