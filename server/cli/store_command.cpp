// leafcutter store copy: all rows and files of a workshop to another place.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "server/cli/command.h"
#include "server/store/sql/copy.h"
#include "server/store/store.h"

namespace leafcutter::server {

namespace {

namespace fs = std::filesystem;

struct CopyOptions {
    std::string from;
    std::string to;
    std::string from_state;
    std::string to_state;
};

bool is_uri(const std::string& place) {
    return place.starts_with("postgresql://") || place.starts_with("postgres://");
}

// A place of rows, locked or known to be unused.
struct Place {
    std::unique_ptr<StateDir> folder;  // Null: rows on a server, and no files named with them.
    OpenedEngine opened;
};

void check_unused(FleetStore& fleet, const std::string& where) {
    constexpr std::int64_t kLivesMs = 60000;
    for (const NodeRecord& node : fleet.nodes()) {
        if (node.silent_ms < kLivesMs) {
            throw UsageError(
                fmt::format("{}: the node {} was heard of {} s ago; stop every node, wait a minute",
                            where, node.id, node.silent_ms / 1000));
        }
    }
}

Place open_place(const std::string& where, const std::string& state) {
    Place place;
    StoreChoice choice;
    const std::string folder = is_uri(where) ? state : where;
    if (is_uri(where)) {
        choice.uri = where;
    }
    if (!folder.empty()) {
        place.folder = std::make_unique<StateDir>(folder);
    }
    place.opened =
        open_engine(folder.empty() ? fs::temp_directory_path() : fs::path(folder), nullptr, choice);
    if (const std::string trouble = place.opened.engine->trouble(); !trouble.empty()) {
        throw UsageError(fmt::format("{}: {}", where, trouble));
    }
    check_unused(place.opened.engine->fleet(), is_uri(where) ? "the database" : where);
    return place;
}

bool is_of_interest(const fs::path& name) {
    return name == "blobs" || name == "journals";
}

std::int64_t copy_files(const fs::path& from, const fs::path& to) {
    std::int64_t copied = 0;
    for (const auto& shelf : fs::directory_iterator(from)) {
        if (!is_of_interest(shelf.path().filename())) {
            continue;
        }
        for (const auto& entry : fs::recursive_directory_iterator(shelf.path())) {
            const fs::path target = to / fs::relative(entry.path(), from);
            if (entry.is_directory()) {
                fs::create_directories(target);
            } else if (!fs::exists(target)) {
                fs::create_directories(target.parent_path());
                fs::copy_file(entry.path(), target);
                ++copied;
            }
        }
    }
    return copied;
}

void copy(const CopyOptions& options) {
    if (options.from == options.to) {
        throw UsageError("FROM and TO are the same place");
    }
    const Place from = open_place(options.from, options.from_state);
    const Place to = open_place(options.to, options.to_state);
    std::int64_t rows = 0;
    try {
        for (const CopiedTable& table :
             copy_all_rows(from.opened.engine->rows(), to.opened.engine->rows())) {
            fmt::print("{:<12} {:>9}\n", table.name, table.rows);
            rows += table.rows;
        }
    } catch (const CopyRefused& error) {
        throw UsageError(error.what());
    }
    fmt::print("{} rows copied and compared\n", rows);
    if (from.folder && to.folder) {
        fmt::print("{} files copied\n", copy_files(from.folder->path(), to.folder->path()));
    } else {
        fmt::print("no files copied: name the state folders with --from-state and --to-state\n");
    }
    std::fflush(stdout);
}

}  // namespace

void add_store_command(CLI::App& app, const CommonOptions&) {
    CLI::App* store = app.add_subcommand("store", "What a daemon remembers, moved elsewhere");
    store->require_subcommand(1);
    CLI::App* command = store->add_subcommand(
        "copy", "All rows and files from one place to an empty one, while no daemon runs");
    const auto options = std::make_shared<CopyOptions>();  // Shared with the callback.
    command->add_option("from", options->from, "A state folder, or postgresql://…")->required();
    command->add_option("to", options->to, "Likewise")->required();
    command->add_option("--from-state", options->from_state,
                        "Folder of the files of postgresql://…");
    command->add_option("--to-state", options->to_state, "Likewise");
    command->callback([options] { copy(*options); });
}

}  // namespace leafcutter::server
