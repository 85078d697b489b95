// leafcutter stock, presets, and the daemon's side of materials: what a workshop keeps, listed,
// exported and imported as JSON.

#include "server/cli/shelf_commands.h"

#include <cstddef>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "server/cli/api_client.h"
#include "server/cli/command.h"
#include "server/cli/input_file.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

struct ShelfOptions {
    ApiOptions api;
    std::string file;
};

using Options = std::shared_ptr<ShelfOptions>;

std::string cell(const json& entry, const char* key) {
    const auto found = entry.find(key);
    if (found == entry.end() || found->is_null()) {
        return "-";
    }
    return found->is_string() ? found->get<std::string>() : found->dump();
}

void print_line(const std::string& shelf, const json& entry) {
    if (shelf == "stock") {
        fmt::print("{:<24} {:<18} {:>4} x {:>4} mm  {:>3} at hand  {:>3} planned  {}\n",
                   cell(entry, "id"), cell(entry, "material"), cell(entry, "width_mm"),
                   cell(entry, "height_mm"), cell(entry, "quantity"), cell(entry, "planned"),
                   cell(entry, "kind"));
    } else {
        fmt::print("{:<28} {:<9} {}\n", cell(entry, "id"), cell(entry, "origin"),
                   cell(entry, "name"));
    }
}

// All of them: page by page.
json whole_shelf(ApiClient& client, const std::string& shelf) {
    json all = client.get("/" + shelf);
    json page = all;
    while (page.count("next_cursor") != 0 && page.at("next_cursor").is_string()) {
        page = client.get(
            fmt::format("/{}?cursor={}", shelf, page.at("next_cursor").get<std::string>()));
        for (const json& entry : page.at(shelf)) {
            all.at(shelf).push_back(entry);
        }
    }
    all.erase("next_cursor");
    return all;
}

void list_shelf(const std::string& shelf, const ApiOptions& api, const CommonOptions& common) {
    ApiClient client(api);
    const json all = whole_shelf(client, shelf);
    if (common.json) {
        print_json(all);
        return;
    }
    for (const json& entry : all.at(shelf)) {
        print_line(shelf, entry);
    }
}

void export_shelf(const std::string& shelf, const ShelfOptions& options) {
    ApiClient client(options.api);
    const std::string text = whole_shelf(client, shelf).dump(2);
    if (options.file.empty() || options.file == "-") {
        fmt::print("{}\n", text);
        return;
    }
    std::ofstream out(options.file, std::ios::binary);
    out << text << '\n';
    out.close();
    if (!out) {
        throw UsageError(fmt::format("{}: can't be written", options.file));
    }
}

std::string text_of(const std::string& file) {
    if (file == "-") {
        return {std::istreambuf_iterator<char>(std::cin), {}};
    }
    constexpr std::size_t kMostBytes = std::size_t{8} << 20;
    const std::vector<std::byte> bytes = read_input_file(file, kMostBytes);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void import_shelf(const std::string& shelf,
                  const ShelfOptions& options,
                  const CommonOptions& common) {
    const json body = json::parse(text_of(options.file), nullptr, /*allow_exceptions=*/false);
    if (!body.is_object() || body.count(shelf) == 0) {
        throw UsageError(fmt::format("{}: is no JSON with a list \"{}\", as export writes it",
                                     options.file, shelf));
    }
    const json answer = ApiClient(options.api).post("/" + shelf, body);
    if (common.json) {
        print_json(answer);
    } else {
        fmt::print("{} entries taken\n", body.at(shelf).size());
    }
}

}  // namespace

void add_shelf_verbs(CLI::App& command, const std::string& shelf, const CommonOptions& common) {
    const auto options = std::make_shared<ShelfOptions>();  // Shared with the callbacks.
    CLI::App* list = command.add_subcommand("list", "Those of the daemon");
    CLI::App* out = command.add_subcommand("export", "Those of the daemon as JSON");
    CLI::App* in = command.add_subcommand("import", "Take over what export wrote");
    for (CLI::App* verb : {list, out, in}) {
        add_api_options(*verb, options->api);
    }
    out->add_option("file", options->file, "Where to; stdout if not given");
    in->add_option("file", options->file, "JSON; - is stdin")->required();
    list->callback([shelf, options, &common] { list_shelf(shelf, options->api, common); });
    out->callback([shelf, options] { export_shelf(shelf, *options); });
    in->callback([shelf, options, &common] { import_shelf(shelf, *options, common); });
}

void add_stock_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* command = app.add_subcommand("stock", "Sheets and remnants at hand");
    command->require_subcommand(1);
    add_shelf_verbs(*command, "stock", common);
}

void add_presets_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* command = app.add_subcommand("presets", "Job parameters under a name");
    command->require_subcommand(1);
    add_shelf_verbs(*command, "presets", common);
}

}  // namespace leafcutter::server
