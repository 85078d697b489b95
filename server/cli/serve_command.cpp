// leafcutter serve: the daemon.

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <sys/resource.h>
#include <unistd.h>
#include <utility>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "drivers/device.h"
#include "server/app.h"
#include "server/cli/command.h"
#include "server/cli/interrupt.h"
#include "server/cli/service_notice.h"
#include "server/log_format.h"
#include "server/queue/compute_child.h"
#include "server/recut_compute.h"
#include "server/test_card.h"
#include "server/weave_compute.h"

namespace leafcutter::server {

namespace {

struct ServeOptions {
    std::string config;
    std::string listen;
    std::string state;
    std::string store;
    std::string role;
    std::string node;
};

Config wanted_config(const ServeOptions& options) {
    try {
        Config config = options.config.empty() ? Config{} : read_config(options.config);
        if (!options.listen.empty()) {
            config.listen = parse_listen(options.listen);
        }
        if (!options.state.empty()) {
            config.state = options.state;
        }
        if (!options.store.empty()) {
            config.store = options.store;
        }
        // A secret: no argument, which everybody on the host could read.
        if (const char* key = std::getenv("LEAFCUTTER_FLEET_KEY"); key != nullptr) {
            config.fleet_key = key;
        }
        if (!options.node.empty()) {
            config.node = options.node;
        }
        if (!options.role.empty()) {
            config.role = node_role_named(options.role).value();
        }
        check_fleet(config);
        if (config.state.empty()) {
            config.state = default_state_dir();
        }
        return config;
    } catch (const BadConfig& error) {
        throw UsageError(error.what());
    }
}

void wait_for_stop(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    never.wait(lock, stop, [] { return false; });
}

std::unique_ptr<App> started(const Config& config, AppParts parts) {
    try {
        return std::make_unique<App>(config, std::move(parts));
    } catch (const BadConfig& error) {
        throw UsageError(error.what());
    }
}

ComputeBudget budget_of(const Config& config) {
    ComputeBudget budget;
    budget.memory_bytes = std::uint64_t{config.job_memory_mb} << 20U;
    if (budget.memory_bytes == 0) {
        const auto pages = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES));
        const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
        budget.memory_bytes = pages * page / 4 * 3 / std::max(1U, config.compute_workers);
    }
    budget.time = std::chrono::minutes(config.job_minutes);
    return budget;
}

// As many files as the host allows: live events alone may be a thousand.
void open_all_files() {
    rlimit files{};
    if (::getrlimit(RLIMIT_NOFILE, &files) == 0) {
        files.rlim_cur = files.rlim_max;
        ::setrlimit(RLIMIT_NOFILE, &files);
    }
}

void serve(const ServeOptions& options) {
    std::signal(SIGPIPE, SIG_IGN);
    open_all_files();
    const InterruptWatch interrupt;
    const Config config = wanted_config(options);
    begin_log(config.log_format);
    AppParts parts;
    parts.compute = compute_in_child(budget_of(config));
    parts.open_device = [](std::string_view uri) { return drivers::open_device(uri); };
    parts.check_params = check_job_params;
    parts.check_recut = check_job_recut;
    parts.test_card = make_test_card;
    const std::unique_ptr<App> app = started(config, std::move(parts));
    const bool v6 = config.listen.address.find(':') != std::string::npos;
    const std::string address = v6 ? "[" + config.listen.address + "]" : config.listen.address;
    std::printf("leafcutter: http://%s:%d/\n", address.c_str(), app->port());
    std::fflush(stdout);
    spdlog::info("state in {}", config.state.string());
    notify_service_manager("READY=1");
    wait_for_stop(interrupt.token());
    notify_service_manager("STOPPING=1");
    spdlog::info("stopping");
}

}  // namespace

void add_serve_command(CLI::App& app, const CommonOptions&) {
    CLI::App* command =
        app.add_subcommand("serve", "The daemon: REST, dashboard, job queue, machines");
    const auto options = std::make_shared<ServeOptions>();  // Shared with the callback.
    command->add_option("--config", options->config, "TOML file")->check(CLI::ExistingFile);
    command->add_option("--listen", options->listen, "ADDRESS:PORT; 127.0.0.1:8080 if not given");
    command->add_option("--state", options->state, "Folder of the database and the files");
    command
        ->add_option("--store", options->store,
                     "postgresql://… that a fleet shares; SQLite in the state folder if not given")
        ->envname("LEAFCUTTER_STORE");
    command->add_option("--role", options->role, "What this node does in a fleet")
        ->check(CLI::IsMember({"all", "api", "worker", "station"}));
    command->add_option("--node", options->node, "Its name in a fleet; the host's if not given");
    command->callback([options] { serve(*options); });
}

}  // namespace leafcutter::server
