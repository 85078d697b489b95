#include "drivers/sim/sim_transport.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "drivers/sim/faulty_machine.h"
#include "drivers/sim/faulty_wire.h"
#include "drivers/sim/marlin_machine.h"
#include "drivers/sim/sim_host.h"
#include "drivers/sim/smoothie_machine.h"

namespace leafcutter::drivers {

namespace {

class SimTransport final : public Transport {
public:
    SimTransport(std::unique_ptr<SimMachine> machine, const SimHostOptions& options)
        : host_(open_pty_link(), std::move(machine), options),
          link_(open_transport(host_.address())) {}

    std::string read_some(std::chrono::milliseconds timeout) override {
        return link_->read_some(timeout);
    }
    void write_all(std::string_view bytes) override { link_->write_all(bytes); }
    std::string description() const override {
        return "simulated machine at " + link_->description();
    }

private:
    SimHost host_;
    std::unique_ptr<Transport> link_;  // Closed before the machine is switched off.
};

struct SimGrblOptions {
    SimHostOptions host;
    GrblMachineOptions machine;
    std::vector<Fault> faults;
};

struct SimLineOptions {
    SimHostOptions host;
    std::optional<WireFault> fault;
};

double read_number(std::string_view key, std::string_view value) {
    double number = 0.0;
    const char* const last = value.data() + value.size();
    const auto [end, error] = std::from_chars(value.data(), last, number);
    if (error != std::errc{} || end != last || !(number >= 0.0)) {
        throw std::invalid_argument(
            fmt::format("simulated machine: {} must be a number of 0 or more", key));
    }
    return number;
}

bool set_host_option(std::string_view key, std::string_view value, SimHostOptions& options) {
    if (key == "burn") {
        options.burn_path = value;
    } else if (key == "speed") {
        options.speed = read_number(key, value);
    } else {
        return false;
    }
    return true;
}

[[noreturn]] void refuse(std::string_view key, std::string_view known) {
    throw std::invalid_argument(fmt::format(
        "simulated machine: unknown option \"{}\"; known are burn, speed, {}", key, known));
}

void set_grbl_option(std::string_view key, std::string_view value, SimGrblOptions& options) {
    if (key == "width") {
        options.machine.bed_width_mm = read_number(key, value);
    } else if (key == "height") {
        options.machine.bed_height_mm = read_number(key, value);
    } else if (key == "fault") {
        options.faults = parse_faults(value);
    } else if (!set_host_option(key, value, options.host)) {
        refuse(key, "width, height, fault");
    }
}

void set_line_option(std::string_view key, std::string_view value, SimLineOptions& options) {
    if (key == "fault") {
        options.fault = parse_wire_fault(value);
    } else if (!set_host_option(key, value, options.host)) {
        refuse(key, "fault");
    }
}

template <typename Options, typename Set>
Options read_options(std::string_view query, const Set& set) {
    Options options;
    while (!query.empty()) {
        const std::size_t end = std::min(query.find('&'), query.size());
        const std::string_view pair = query.substr(0, end);
        query.remove_prefix(std::min(end + 1, query.size()));
        const std::size_t equals = std::min(pair.find('='), pair.size());
        set(pair.substr(0, equals), pair.substr(std::min(equals + 1, pair.size())), options);
    }
    return options;
}

std::unique_ptr<Transport> open_line_machine(std::unique_ptr<SimMachine> machine,
                                             std::string_view query) {
    const auto options = read_options<SimLineOptions>(query, set_line_option);
    if (options.fault) {
        machine = std::make_unique<FaultyWire>(std::move(machine), *options.fault);
    }
    return std::make_unique<SimTransport>(std::move(machine), options.host);
}

}  // namespace

std::unique_ptr<Transport> open_simulated_grbl(std::string_view query) {
    const auto options = read_options<SimGrblOptions>(query, set_grbl_option);
    return std::make_unique<SimTransport>(
        std::make_unique<FaultyMachine>(options.machine, options.faults), options.host);
}

std::unique_ptr<Transport> open_simulated_marlin(std::string_view query) {
    return open_line_machine(std::make_unique<MarlinMachine>(), query);
}

std::unique_ptr<Transport> open_simulated_smoothie(std::string_view query) {
    return open_line_machine(std::make_unique<SmoothieMachine>(), query);
}

}  // namespace leafcutter::drivers
