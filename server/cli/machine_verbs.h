// What an operator does with one machine of the daemon, as subcommands of `leafcutter devices`.

#pragma once

#include <memory>

#include "server/cli/api_client.h"
#include "server/cli/command.h"

namespace leafcutter::server {

// `api` is what the options of `devices` are read into; `common` outlives the callbacks.
void add_machine_verbs(CLI::App& devices,
                       const std::shared_ptr<ApiOptions>& api,
                       const CommonOptions& common);

// A line for each, or the whole answer as JSON.
void print_machines(const nlohmann::json& answer, const CommonOptions& common);

}  // namespace leafcutter::server
