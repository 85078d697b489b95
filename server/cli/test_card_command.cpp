// leafcutter test-card kerf|power: a card to be cut before the real thing, as a job of the daemon
// or as a package.

#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/cli/api_client.h"
#include "server/cli/command.h"
#include "server/cli/material_options.h"
#include "server/cli/package_dir.h"
#include "server/test_card.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

struct CardOptions {
    ApiOptions api;
    json wish;
    std::string output;
    std::string materials_file;
};

using Options = std::shared_ptr<CardOptions>;

// What is given goes into the wish; the rest is left to the card's own defaults.
template <typename Value>
void add_wish(CLI::App& command, const Options& options, const char* key, const char* help) {
    std::string name = fmt::format("--{}", key);
    for (char& letter : name) {
        letter = letter == '_' ? '-' : letter;
    }
    command.add_option_function<Value>(
        name, [options, key](const Value& value) { options->wish[key] = value; }, help);
}

void make_card(const CardOptions& options, const CommonOptions& common) {
    if (!options.output.empty()) {
        const PackageDir directory(options.output);
        const ComputeOutput card =
            test_card_from(options.wish, wanted_materials(options.materials_file));
        directory.write(card.package);
        if (!common.json) {
            fmt::print("{}\n", json::parse(card.summary_json).at("reading").get<std::string>());
        }
        return;
    }
    const json job = ApiClient(options.api).post("/test-cards", options.wish);
    if (common.json) {
        print_json(job);
    } else {
        fmt::print("{}\n{}\n", job.at("id").get<std::string>(),
                   job.at("summary").at("reading").get<std::string>());
    }
}

void add_shared_options(CLI::App& command, const Options& options) {
    add_api_options(command, options->api);
    add_wish<std::string>(command, options, "material", "A material's id");
    command.get_option("--material")->required();
    add_wish<std::string>(command, options, "machine", "Of the material's settings");
    add_wish<std::string>(command, options, "dialect", "grbl, marlin or smoothie");
    add_wish<double>(command, options, "cell_mm", "Size of a cell");
    command.add_option("-o,--output", options->output, "Write a package here, without a daemon");
    command
        .add_option("--materials", options->materials_file,
                    "A JSON file with materials of your own, for --output")
        ->needs("--output");
}

}  // namespace

void add_test_card_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* command =
        app.add_subcommand("test-card", "Find out a material's kerf, or its power and speed");
    command->require_subcommand(1);
    const auto options = std::make_shared<CardOptions>();  // Shared with the callbacks.
    CLI::App* kerf = command->add_subcommand("kerf", "How wide the beam is");
    CLI::App* power = command->add_subcommand("power", "A cell for every power and every feed");
    for (CLI::App* each : {kerf, power}) {
        add_shared_options(*each, options);
    }
    add_wish<int>(*kerf, options, "cells", "How many");
    add_wish<double>(*kerf, options, "largest_kerf_mm", "Where the ruler ends");
    add_wish<std::string>(*power, options, "operation", "cut, score or engrave");
    add_wish<std::vector<double>>(*power, options, "power_percent", "From and to");
    add_wish<std::vector<double>>(*power, options, "feed_mm_per_min", "From and to");
    add_wish<int>(*power, options, "powers", "Columns");
    add_wish<int>(*power, options, "feeds", "Rows");
    add_wish<int>(*power, options, "passes", "Over each cell");
    kerf->callback([options, &common] {
        options->wish["kind"] = "kerf";
        make_card(*options, common);
    });
    power->callback([options, &common] {
        options->wish["kind"] = "power";
        make_card(*options, common);
    });
}

}  // namespace leafcutter::server
