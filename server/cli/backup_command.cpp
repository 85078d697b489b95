// leafcutter backup: a copy of the daemon's rows, made now; and which copies there are.

#include <cstdio>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "server/cli/api_client.h"
#include "server/cli/command.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

void print_backups(const json& answer, const CommonOptions& common) {
    if (common.json) {
        print_json(answer);
        return;
    }
    for (const json& backup : answer.at("backups")) {
        std::printf("%-40s %12lld bytes\n", backup.at("name").get<std::string>().c_str(),
                    backup.at("bytes").get<long long>());
    }
}

}  // namespace

void add_backup_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* command = app.add_subcommand("backup", "Copy the daemon's database now");
    const auto api = std::make_shared<ApiOptions>();  // Shared with the callback.
    const auto list = std::make_shared<bool>(false);
    add_api_options(*command, *api);
    command->add_flag("--list", *list, "Make none: show those there are, newest first");
    command->callback([api, list, &common] {
        ApiClient client(*api);
        if (*list) {
            print_backups(client.get("/backups"), common);
            return;
        }
        const json made = client.post("/backups", json::object());
        if (common.json) {
            print_json(made);
        } else {
            std::printf("%s\n", made.at("name").get<std::string>().c_str());
        }
    });
}

}  // namespace leafcutter::server
