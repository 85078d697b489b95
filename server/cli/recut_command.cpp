// `leafcutter recut PACKAGE PIECE…`: sheets for single pieces of a finished package again.

#include <charconv>
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

#include "server/cli/command.h"
#include "server/cli/input_file.h"
#include "server/cli/interrupt.h"
#include "server/cli/material_options.h"
#include "server/cli/package_dir.h"
#include "server/json_reader.h"
#include "server/material_json.h"
#include "server/outline_json.h"
#include "server/params.h"
#include "server/recut.h"
#include "server/recut_wishes.h"
#include "server/zip_reader.h"

namespace leafcutter::server {

namespace {

constexpr std::size_t kMostBytes = std::size_t{4} << 30;

struct RecutArguments {
    std::string package;
    std::string output;
    std::string sheet;
    std::string remnant_file;
    std::string materials_file;
    RecutWishes wishes;
};

std::string read_text(const std::string& path) {
    const std::vector<std::byte> bytes = read_input_file(path, kMostBytes);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

PackageSource source_of(const std::string& package) {
    std::error_code failure;
    if (std::filesystem::is_regular_file(package, failure)) {
        const auto archive = std::make_shared<ZipReader>(read_text(package), package);
        return {package, [archive](const std::string& path) { return archive->read(path); }};
    }
    if (!std::filesystem::is_directory(package, failure)) {
        throw UsageError(
            fmt::format("{}: is neither a package's directory nor its archive", package));
    }
    return {package, [package](const std::string& path) {
                return read_text((std::filesystem::path(package) / path).string());
            }};
}

// "210x148".
fab::SheetSize sheet_from(const std::string& text) {
    fab::SheetSize size;
    const char* end = text.data() + text.size();
    const auto width = std::from_chars(text.data(), end, size.width_mm);
    if (width.ec == std::errc() && width.ptr != end && *width.ptr == 'x') {
        const auto height = std::from_chars(width.ptr + 1, end, size.height_mm);
        const bool fine = height.ec == std::errc() && height.ptr == end && size.width_mm > 0.0 &&
                          size.height_mm > 0.0 && size.width_mm <= kLargestLengthMm &&
                          size.height_mm <= kLargestLengthMm;
        if (fine) {
            return size;
        }
    }
    throw UsageError(fmt::format("--sheet {}: must be WIDTHxHEIGHT in mm: 210x148", text));
}

RecutWishes wishes_of(const RecutArguments& arguments) {
    RecutWishes wishes = arguments.wishes;
    if (!arguments.sheet.empty()) {
        wishes.sheet = sheet_from(arguments.sheet);
    }
    if (!arguments.remnant_file.empty()) {
        const nlohmann::json file =
            parse_params_text(read_text(arguments.remnant_file), arguments.remnant_file);
        wishes.remnant = read_outline(file, arguments.remnant_file);
    }
    wishes.instead = materials_of_file(arguments.materials_file);
    if (wishes.sheet && !wishes.remnant.empty()) {
        throw UsageError("--sheet: not together with --remnant");
    }
    return wishes;
}

std::string output_of(const RecutArguments& arguments) {
    if (!arguments.output.empty()) {
        return arguments.output;
    }
    std::filesystem::path package = std::filesystem::weakly_canonical(arguments.package);
    return package.parent_path() / (package.stem().string() + "-recut");
}

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

void run_recut(const RecutArguments& arguments, const CommonOptions& common) {
    const RecutWishes wishes = wishes_of(arguments);
    const PackageSource source = source_of(arguments.package);
    const std::vector<fab::Material> materials =
        with_materials(fab::built_in_materials(), wishes.instead);
    const std::string output = output_of(arguments);
    const PackageDir directory(output);
    const InterruptWatch interrupt;
    geometry::Context context;
    context.stop = interrupt.token();
    context.threads = std::max(1U, std::thread::hardware_concurrency());
    context.clock_s = steady_seconds;
    const fab::RecutSummary summary = recut_package(source, wishes, materials, context);
    directory.write(summary.package);
    if (common.json) {
        const nlohmann::json line = {{"done", output},
                                     {"sheets", summary.sheets},
                                     {"pieces", summary.pieces},
                                     {"estimated_s", summary.estimated_s}};
        fmt::print(stderr, "{}\n", line.dump());
    } else if (isatty(STDERR_FILENO) != 0) {
        fmt::print(stderr, "{}: {} piece(s) on {} sheet(s), about {:.0f} s to cut\n", output,
                   summary.pieces, summary.sheets, summary.estimated_s);
    }
}

}  // namespace

void add_recut_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* command =
        app.add_subcommand("recut", "Sheets for single pieces of a finished package again");
    const auto arguments = std::make_shared<RecutArguments>();  // Lives as long as the callback.
    command->add_option("package", arguments->package, "A package: its directory or .zip")
        ->required();
    command
        ->add_option("pieces", arguments->wishes.pieces,
                     "A piece (W12.1), a whole strip (W12), a sheet (sheet:3), or all")
        ->required();
    command->add_option("-o,--output", arguments->output,
                        "Directory to write (default: PACKAGE-recut)");
    command->add_option("--sheet", arguments->sheet,
                        "Size of the sheet to cut from, in mm: 210x148");
    command->add_option("--remnant", arguments->remnant_file,
                        "Outline of the material to cut from, a JSON file: [[x, y], ...] in mm");
    command->add_option("--material", arguments->wishes.material,
                        "Another material than the package's");
    command->add_option("--materials", arguments->materials_file,
                        "A JSON file with materials of your own");
    command->add_option("--time", arguments->wishes.time_s, "Seconds to search for a good layout")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command->callback([arguments, &common] { run_recut(*arguments, common); });
}

}  // namespace leafcutter::server
