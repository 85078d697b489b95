// leafcutter health: whether the daemon takes work. For containers and other watchers.

#include <cstdio>
#include <memory>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "server/cli/api_client.h"
#include "server/cli/command.h"

namespace leafcutter::server {

void add_health_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* command = app.add_subcommand("health", "Whether the daemon takes work");
    const auto api = std::make_shared<ApiOptions>();  // Shared with the callback.
    add_api_options(*command, *api);
    command->callback([api, &common] {
        const nlohmann::json answer = ApiClient(*api).readiness();
        if (common.json) {
            print_json(answer);
        }
        if (answer.value("status", "") != "ready") {
            throw std::runtime_error(fmt::format("{}: not ready: {}", api->url,
                                                 answer.value("database", true)
                                                     ? "the disk has no room for a job"
                                                     : answer.value("trouble", "")));
        }
        if (!common.json) {
            std::printf("ready\n");
        }
    });
}

}  // namespace leafcutter::server
