// `leafcutter send PROGRAM --device URI`: streams a G-code or EGV file to a machine, no daemon.

#include <algorithm>
#include <chrono>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "drivers/device.h"
#include "drivers/lihuiyu/address.h"
#include "drivers/lihuiyu/egv.h"
#include "drivers/transport.h"
#include "geometry/error.h"
#include "server/cli/command.h"
#include "server/cli/input_file.h"
#include "server/cli/interrupt.h"
#include "server/cli/progress_line.h"

namespace leafcutter::server {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr std::size_t kLargestProgram = std::size_t{512} << 20U;
constexpr milliseconds kSlice{50};
constexpr milliseconds kShowEvery{250};
constexpr std::chrono::seconds kCancelTime{10};
constexpr std::chrono::seconds kHomeTime{90};

struct SendOptions {
    std::string program;
    std::string device;
    std::string egv;
    bool home = false;
};

std::string read_text(const std::string& path) {
    const std::vector<std::byte> bytes = read_input_file(path, kLargestProgram);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::unique_ptr<drivers::Device> open(const std::string& uri) {
    try {
        return drivers::open_device(uri);
    } catch (const std::invalid_argument& error) {
        throw UsageError(error.what());
    }
}

void show(const drivers::Device& device, ProgressLine& line) {
    const drivers::JobProgress progress = device.progress();
    const drivers::DeviceStatus status = device.status();
    const std::string text = fmt::format(
        "{}, line {} of {}, X{:.0f} Y{:.0f}", to_string(status.state), progress.lines_acknowledged,
        progress.lines_total, status.work_position_mm[0], status.work_position_mm[1]);
    const std::size_t total = std::max<std::size_t>(progress.lines_total, 1);
    line.show(text, static_cast<double>(progress.lines_acknowledged) / static_cast<double>(total));
}

void start(drivers::Device& device, std::string program) {
    try {
        device.start(std::move(program));
    } catch (const drivers::ProgramRefused& error) {
        throw UsageError(error.what());
    }
}

void run_to_end(drivers::Device& device, ProgressLine& line, const std::stop_token& interrupt) {
    bool cancelled = false;
    Clock::time_point cancelled_at{};
    Clock::time_point shown{};
    while (device.progress().outcome == drivers::JobOutcome::Running) {
        if (interrupt.stop_requested() && !cancelled) {
            cancelled = true;
            cancelled_at = Clock::now();
            device.cancel();
        }
        if (cancelled && Clock::now() - cancelled_at > kCancelTime) {
            device.stop();
        }
        device.run_once(kSlice);
        if (Clock::now() - shown >= kShowEvery) {
            shown = Clock::now();
            show(device, line);
        }
    }
    line.clear();
    if (cancelled) {
        throw geometry::Cancelled();
    }
}

void home(drivers::Device& device, const std::stop_token& interrupt) {
    device.home();
    const Clock::time_point end = Clock::now() + kHomeTime;
    do {
        device.run_once(kSlice);
        if (interrupt.stop_requested()) {
            device.stop();
            device.run_once(kSlice);
            throw geometry::Cancelled();
        }
        if (Clock::now() > end) {
            throw DeviceFailed(device.uri() + ": homing doesn't end");
        }
    } while (device.status().state != drivers::MachineState::Idle);
}

constexpr std::string_view kLihuiyu = "lihuiyu:";

bool is_lihuiyu(std::string_view device) {
    return device.substr(0, kLihuiyu.size()) == kLihuiyu || device.substr(0, 11) == "sim:lihuiyu";
}

// What the device's address says of its board and bed goes into the file; nothing is sent.
void write_egv_file(const std::string& program, const SendOptions& options) {
    if (options.device.substr(0, kLihuiyu.size()) != kLihuiyu) {
        throw UsageError("--egv: needs --device lihuiyu:usb?board=M2 or the like");
    }
    std::string egv;
    try {
        const std::string_view address = std::string_view(options.device).substr(kLihuiyu.size());
        egv = drivers::convert_to_egv(program, drivers::parse_lihuiyu_address(address).encoder);
    } catch (const std::invalid_argument& error) {
        throw UsageError(error.what());
    } catch (const drivers::ProgramRefused& error) {
        throw UsageError(fmt::format("{}: {}", options.program, error.what()));
    }
    std::ofstream file(options.egv, std::ios::binary | std::ios::trunc);
    file << egv;
    if (!file.flush()) {
        throw UsageError(options.egv + ": can't be written");
    }
}

void send(const SendOptions& options, const CommonOptions& common) {
    std::string program = read_text(options.program);
    if (drivers::is_egv(program) && !is_lihuiyu(options.device)) {
        throw UsageError(options.program + ": EGV files are for lihuiyu devices");
    }
    if (!options.egv.empty()) {
        write_egv_file(program, options);
        return;
    }
    const InterruptWatch interrupt;
    const std::unique_ptr<drivers::Device> device = open(options.device);
    ProgressLine line(common);
    if (options.home) {
        home(*device, interrupt.token());
    }
    start(*device, std::move(program));
    run_to_end(*device, line, interrupt.token());
    const drivers::JobProgress progress = device->progress();
    if (progress.outcome != drivers::JobOutcome::Done) {
        throw DeviceFailed(options.device + ": " + progress.reason);
    }
}

}  // namespace

void add_send_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* command =
        app.add_subcommand("send", "Streams a G-code or EGV program to a device, with progress");
    const auto options = std::make_shared<SendOptions>();  // Lives as long as the callback.
    command->add_option("program", options->program, "A G-code file, or EGV for lihuiyu devices")
        ->required();
    command
        ->add_option("--device", options->device,
                     "grbl:/dev/PORT?baud=N, grbl:tcp://host:port, marlin: and smoothie: alike, "
                     "lihuiyu:usb?bus=N&address=N&board=M2, sim:grbl, sim:marlin, sim:smoothie, "
                     "sim:lihuiyu")
        ->required();
    command->add_option("--egv", options->egv,
                        "Writes the program as an EGV file for this lihuiyu device, and sends "
                        "nothing");
    command->add_flag("--home", options->home,
                      "Homes the machine first; a lihuiyu board must be, after power-up or a stop");
    command->callback([options, &common] { send(*options, common); });
}

}  // namespace leafcutter::server
