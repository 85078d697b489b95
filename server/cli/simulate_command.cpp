// `leafcutter simulate grbl`: a simulated machine that any program can drive, until Ctrl-C.

#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>

#include "drivers/sim/sim_host.h"
#include "server/cli/command.h"
#include "server/cli/interrupt.h"

namespace leafcutter::server {

namespace {

struct SimulateOptions {
    std::string machine;
    std::string pty;
    std::optional<unsigned short> tcp_port;
    std::string fault;
    drivers::SimHostOptions host;
};

std::unique_ptr<drivers::SimLink> open_link(const SimulateOptions& options) {
    return options.tcp_port ? drivers::open_tcp_link(*options.tcp_port)
                            : drivers::open_pty_link(options.pty);
}

void simulate(SimulateOptions& options) {
    if (options.machine != "grbl") {
        throw UsageError("simulate: \"" + options.machine +
                         "\" is not supported yet; only grbl is");
    }
    try {
        if (!options.fault.empty()) {
            options.host.fault = drivers::parse_fault(options.fault);
        }
        const InterruptWatch interrupt;
        const drivers::SimHost host(open_link(options), options.host);
        std::printf("grbl:%s\n", host.address().c_str());
        std::fflush(stdout);
        while (!interrupt.token().stop_requested()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
    } catch (const std::invalid_argument& error) {
        throw UsageError(error.what());
    }
}

}  // namespace

void add_simulate_command(CLI::App& app, const CommonOptions& /*common*/) {
    CLI::App* command = app.add_subcommand(
        "simulate", "A simulated machine that any program can drive; prints its device URI");
    const auto options = std::make_shared<SimulateOptions>();  // Lives as long as the callback.
    command->add_option("machine", options->machine, "grbl")->required();
    CLI::Option* pty =
        command->add_option("--pty", options->pty, "Path of a symbolic link to its serial port");
    command->add_option("--tcp", options->tcp_port, "Port on the loopback; 0 picks a free one")
        ->excludes(pty);
    command->add_option("--burn", options->host.burn_path,
                        "Where to write the beam log (JSON lines)");
    command->add_option("--speed", options->host.speed,
                        "Simulated seconds per second; 0: as fast as possible");
    command->add_option(
        "--fault", options->fault,
        "drop-ok:N corrupt-ok:N stall:N alarm:N reset:N unplug:N, at the N-th line");
    command->add_option("--width", options->host.machine.bed_width_mm, "Bed width in mm");
    command->add_option("--height", options->host.machine.bed_height_mm, "Bed height in mm");
    command->callback([options] { simulate(*options); });
}

}  // namespace leafcutter::server
