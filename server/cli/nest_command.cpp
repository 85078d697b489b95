// `leafcutter nest INSTANCE -o LAYOUT [--time S] [--seed N] [--threads N] [--svg FILE]`: the
// nesting engine alone, on an instance in the public JSON form.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "fab/nest/instance.h"
#include "fab/nest/instance_io.h"
#include "server/cli/command.h"
#include "server/cli/input_file.h"
#include "server/cli/interrupt.h"
#include "server/cli/progress_line.h"

namespace leafcutter::server {

namespace {

struct NestCommandOptions {
    std::string instance;
    std::string output;
    std::string svg;
    double time_s = 10.0;
    std::int64_t evaluations = 0;
    std::uint32_t seed = 1;
    unsigned threads = 0;
};

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

// Beside the file, then in its place: never half a file.
void write_file(const std::string& path, const std::string& text) {
    const std::string part = path + ".part";
    std::ofstream file(part, std::ios::binary | std::ios::trunc);
    file << text << std::flush;
    if (!file) {
        throw std::runtime_error(fmt::format("{}: cannot be written", path));
    }
    file.close();
    std::filesystem::rename(part, path);
}

std::vector<int> unplaced_ids(const fab::NestInstance& instance,
                              const fab::InstanceSolution& solution) {
    std::vector<int> ids;
    for (const std::size_t item : solution.unplaced) {
        ids.push_back(instance.items[item].id);
    }
    return ids;
}

double cost_of(const fab::NestInstance& instance, const fab::InstanceSolution& solution) {
    double cost = 0.0;
    for (const fab::InstanceLayout& layout : solution.layouts) {
        cost += layout.bin ? instance.bins[*layout.bin].cost : 0.0;
    }
    return cost;
}

void tell(const NestCommandOptions& options,
          const fab::NestInstance& instance,
          const fab::InstanceSolution& solution,
          const CommonOptions& common) {
    if (common.json) {
        fmt::print(stderr, "{}\n",
                   nlohmann::json{{"done", options.output},
                                  {"density", solution.density},
                                  {"strip_width", solution.strip_width},
                                  {"sheets", solution.layouts.size()},
                                  {"unplaced", solution.unplaced.size()},
                                  {"unplaced_items", unplaced_ids(instance, solution)},
                                  {"cost", cost_of(instance, solution)},
                                  {"smallest_gap", solution.smallest_gap},
                                  {"evaluations", solution.evaluations}}
                       .dump());
        return;
    }
    if (instance.strip_height > 0.0) {
        fmt::print("{}: {:.2f} % of {:.6g} x {:.6g}\n", instance.name, 100.0 * solution.density,
                   solution.strip_width, instance.strip_height);
    } else {
        fmt::print("{}: {} bins for {:g}, {:.2f} %\n", instance.name, solution.layouts.size(),
                   cost_of(instance, solution), 100.0 * solution.density);
    }
    if (!solution.unplaced.empty()) {
        fmt::print(stderr, "note: no room for {} items: {}\n", solution.unplaced.size(),
                   fmt::join(unplaced_ids(instance, solution), ", "));
    }
}

void run_nest(const NestCommandOptions& options, const CommonOptions& common) {
    constexpr std::size_t kMostBytes = 64U << 20U;
    const std::vector<std::byte> bytes = read_input_file(options.instance, kMostBytes);
    const fab::NestInstance instance =
        fab::read_instance({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const InterruptWatch interrupt;
    ProgressLine progress(common);
    geometry::Context context;
    context.stop = interrupt.token();
    context.threads =
        options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency());
    context.clock_s = steady_seconds;
    context.progress = [&](std::string_view stage, double fraction) {
        progress.show(stage, fraction);
    };
    fab::CompactionOptions search;
    search.seed = options.seed;
    search.time_s = options.evaluations > 0 ? 0.0 : options.time_s;
    search.max_evaluations = options.evaluations > 0 ? options.evaluations
                                                     : std::numeric_limits<std::int64_t>::max() / 4;
    const fab::InstanceSolution solution = fab::solve(instance, search, context);
    write_file(options.output, fab::write_solution(instance, solution));
    if (!options.svg.empty()) {
        write_file(options.svg, fab::draw_solution(instance, solution));
    }
    progress.clear();
    tell(options, instance, solution, common);
}

}  // namespace

void add_nest_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* command =
        app.add_subcommand("nest", "The nesting engine alone, on a public JSON instance");
    const auto options = std::make_shared<NestCommandOptions>();  // Lives as long as the callback.
    command->add_option("instance", options->instance, "A strip or bin packing problem, JSON")
        ->required();
    command->add_option("-o,--output", options->output, "Layout to write, JSON")->required();
    command->add_option("--time", options->time_s, "Seconds to search")
        ->check(CLI::Range(0.0, 1e6))
        ->capture_default_str();
    command
        ->add_option("--evaluations", options->evaluations,
                     "Places to try instead: the same layout on every machine")
        ->check(CLI::NonNegativeNumber);
    command->add_option("--seed", options->seed, "Of the random numbers")->capture_default_str();
    command->add_option("--threads", options->threads, "To use; the layout does not depend on it");
    command->add_option("--svg", options->svg, "A picture of the layout to write");
    command->callback([options, &common] { run_nest(*options, common); });
}

}  // namespace leafcutter::server
