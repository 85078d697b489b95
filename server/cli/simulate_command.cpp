// `leafcutter simulate grbl|marlin|smoothie|lihuiyu`: a simulated machine that any program can
// drive, until Ctrl-C.

#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "drivers/sim/faulty_machine.h"
#include "drivers/sim/faulty_wire.h"
#include "drivers/sim/lihuiyu_machine.h"
#include "drivers/sim/marlin_machine.h"
#include "drivers/sim/sim_host.h"
#include "drivers/sim/smoothie_machine.h"
#include "server/cli/burn_picture.h"
#include "server/cli/command.h"
#include "server/cli/input_file.h"
#include "server/cli/interrupt.h"

namespace leafcutter::server {

namespace {

struct SimulateOptions {
    std::string machine;
    std::string pty;
    std::optional<unsigned short> tcp_port;
    std::string burn_path;
    std::string burn_picture;
    std::string fault;
    std::string faults_path;
    double speed = 1.0;
    std::optional<double> width_mm;
    std::optional<double> height_mm;
    std::string board = "M2";
};

std::unique_ptr<drivers::SimLink> open_link(const SimulateOptions& options) {
    return options.tcp_port ? drivers::open_tcp_link(*options.tcp_port)
                            : drivers::open_pty_link(options.pty);
}

std::vector<drivers::Fault> faults_of(const SimulateOptions& options) {
    constexpr std::size_t kMostBytes = std::size_t{1} << 20U;
    std::vector<drivers::Fault> faults = drivers::parse_faults(options.fault);
    if (!options.faults_path.empty()) {
        const std::vector<std::byte> script = read_input_file(options.faults_path, kMostBytes);
        const std::vector<drivers::Fault> more =
            drivers::parse_faults({reinterpret_cast<const char*>(script.data()), script.size()});
        faults.insert(faults.end(), more.begin(), more.end());
    }
    return faults;
}

std::unique_ptr<drivers::SimMachine> make_grbl(const SimulateOptions& options) {
    drivers::GrblMachineOptions machine;
    machine.eeprom_time_s = 0.02;  // As an ATmega takes for a setting.
    machine.bed_width_mm = options.width_mm.value_or(machine.bed_width_mm);
    machine.bed_height_mm = options.height_mm.value_or(machine.bed_height_mm);
    return std::make_unique<drivers::FaultyMachine>(machine, faults_of(options));
}

std::unique_ptr<drivers::SimMachine> make_lihuiyu(const SimulateOptions& options) {
    drivers::LihuiyuMachineOptions machine;
    machine.speed.board = drivers::parse_lihuiyu_board(options.board);
    machine.bed.width_mm = options.width_mm.value_or(machine.bed.width_mm);
    machine.bed.height_mm = options.height_mm.value_or(machine.bed.height_mm);
    machine.bed.origin_down_mm = machine.bed.height_mm;
    if (!options.fault.empty()) {
        machine.fault = drivers::parse_lihuiyu_fault(options.fault);
    }
    return std::make_unique<drivers::LihuiyuMachine>(machine);
}

std::unique_ptr<drivers::SimMachine> behind_wire(std::unique_ptr<drivers::SimMachine> machine,
                                                 const SimulateOptions& options) {
    if (options.fault.empty()) {
        return machine;
    }
    return std::make_unique<drivers::FaultyWire>(std::move(machine),
                                                 drivers::parse_wire_fault(options.fault));
}

std::unique_ptr<drivers::SimMachine> make_machine(const SimulateOptions& options) {
    if (options.machine == "grbl") {
        return make_grbl(options);
    }
    if (options.machine == "lihuiyu") {
        return make_lihuiyu(options);
    }
    if (options.machine == "marlin") {
        return behind_wire(std::make_unique<drivers::MarlinMachine>(), options);
    }
    if (options.machine == "smoothie") {
        return behind_wire(std::make_unique<drivers::SmoothieMachine>(), options);
    }
    throw UsageError(fmt::format("simulate: \"{}\": must be grbl, marlin, smoothie or lihuiyu",
                                 options.machine));
}

// What the machine complains about goes to stderr, a line each.
void run_until_interrupted(drivers::SimHost& host, const std::stop_token& interrupt) {
    while (!interrupt.stop_requested()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        for (const drivers::Violation& violation : host.take_violations()) {
            std::fprintf(stderr, "at %.3f s: %s\n", violation.t_s, violation.text.c_str());
        }
    }
}

void simulate(const SimulateOptions& options) {
    if (!options.burn_picture.empty()) {
        check_picture_path(options.burn_picture);
    }
    try {
        const InterruptWatch interrupt;  // Before the machine's thread.
        drivers::SimHost host(open_link(options), make_machine(options),
                              {options.speed, options.burn_path, !options.burn_picture.empty()});
        std::printf("%s:%s\n", options.machine.c_str(), host.address().c_str());
        std::fflush(stdout);
        run_until_interrupted(host, interrupt.token());
        if (!options.burn_picture.empty()) {
            write_burn_picture(options.burn_picture, host.burnt());
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
    command->add_option("machine", options->machine, "grbl, marlin, smoothie or lihuiyu")
        ->required();
    CLI::Option* pty =
        command->add_option("--pty", options->pty, "Path of a symbolic link to its serial port");
    command->add_option("--tcp", options->tcp_port, "Port on the loopback; 0 picks a free one")
        ->excludes(pty);
    command->add_option("--burn", options->burn_path, "Where to write the beam log (JSON lines)");
    command->add_option("--burn-picture", options->burn_picture,
                        "Where to draw what was burnt, at the end: .svg or .png");
    command->add_option("--faults", options->faults_path,
                        "Of grbl: a script of faults as of --fault, one a line");
    command->add_option("--speed", options->speed,
                        "Simulated seconds per second; 0: as fast as possible");
    command->add_option(
        "--fault", options->fault,
        "grbl: drop-byte:N double-byte:N corrupt-byte:N drop-ok:N double-ok:N corrupt-ok:N delay:N "
        "stall:N alarm:N reset:N power:N unplug:N, at the N-th line, several with commas; marlin, "
        "smoothie: flip-bit:N drop-line:N drop-byte:N drop-ok:N garble-ok:N double-ok:N stall:N "
        "reset:N unplug:N, at the N-th line or answer; lihuiyu: "
        "crc:N crc-always:N busy:N stall:N mute:N power:N lose:N unplug:N, at the N-th packet");
    command->add_option("--width", options->width_mm, "Bed width in mm");
    command->add_option("--height", options->height_mm, "Bed height in mm");
    command->add_option("--board", options->board, "Of lihuiyu: A, B, B1, B2, M, M1, M2, M3");
    command->callback([options] { simulate(*options); });
}

}  // namespace leafcutter::server
