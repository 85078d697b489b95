// `leafcutter materials [--materials FILE] [--json]`: the materials that jobs can name;
// `leafcutter materials list|export|import`: the daemon's.

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "server/cli/command.h"
#include "server/cli/material_options.h"
#include "server/cli/shelf_commands.h"
#include "server/material_json.h"

namespace leafcutter::server {

namespace {

std::string sheets_of(const fab::Material& material) {
    std::string text;
    for (const fab::StockSheet& sheet : material.sheets) {
        text += fmt::format("{}{:g}x{:g}", text.empty() ? "" : " ", sheet.size.width_mm,
                            sheet.size.height_mm);
    }
    return text;
}

std::string machines_of(const fab::Material& material) {
    std::string text;
    for (const fab::MachineSettings& settings : material.settings) {
        text += fmt::format("{}{}", text.empty() ? "" : " ", settings.machine);
    }
    return text;
}

void print_table(const std::vector<fab::Material>& materials) {
    std::size_t widest = 8;
    for (const fab::Material& material : materials) {
        widest = std::max(widest, material.id.size());
    }
    fmt::print("{:<{}}  {:>5}  {:>5}  {:>5}  {:>6}  {:<18}  {}\n", "material", widest, "mm", "g/m²",
               "kerf", "radius", "sheets", "machines");
    for (const fab::Material& material : materials) {
        fmt::print("{:<{}}  {:>5g}  {:>5g}  {:>5g}  {:>6g}  {:<18}  {}\n", material.id, widest,
                   material.thickness_mm, material.weight_g_per_m2, material.kerf_mm,
                   material.min_radius_mm, sheets_of(material), machines_of(material));
    }
}

}  // namespace

void add_materials_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* command = app.add_subcommand("materials", "The materials that jobs can name");
    const auto file = std::make_shared<std::string>();  // Lives as long as the callback.
    command->add_option("--materials", *file, "A JSON file with materials of your own");
    command->require_subcommand(0, 1);
    add_shelf_verbs(*command, "materials", common);
    command->callback([command, file, &common] {
        if (!command->get_subcommands().empty()) {
            return;  // About the daemon's.
        }
        const std::vector<fab::Material> materials = wanted_materials(*file);
        if (common.json) {
            fmt::print("{}", materials_to_text(materials));
        } else {
            print_table(materials);
        }
        std::fflush(stdout);
    });
}

}  // namespace leafcutter::server
