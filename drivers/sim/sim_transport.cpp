#include "drivers/sim/sim_transport.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <utility>

#include "drivers/sim/faulty_machine.h"
#include "drivers/sim/sim_host.h"

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
    std::optional<Fault> fault;
};

double read_number(std::string_view key, std::string_view value) {
    double number = 0.0;
    const char* const last = value.data() + value.size();
    const auto [end, error] = std::from_chars(value.data(), last, number);
    if (error != std::errc{} || end != last || !(number >= 0.0)) {
        throw std::invalid_argument("sim:grbl: " + std::string(key) +
                                    " must be a number of 0 or more");
    }
    return number;
}

void set_option(std::string_view key, std::string_view value, SimGrblOptions& options) {
    if (key == "burn") {
        options.host.burn_path = value;
    } else if (key == "speed") {
        options.host.speed = read_number(key, value);
    } else if (key == "width") {
        options.machine.bed_width_mm = read_number(key, value);
    } else if (key == "height") {
        options.machine.bed_height_mm = read_number(key, value);
    } else if (key == "fault") {
        options.fault = parse_fault(value);
    } else {
        throw std::invalid_argument("sim:grbl: unknown option \"" + std::string(key) +
                                    "\"; known are burn, speed, width, height, fault");
    }
}

}  // namespace

std::unique_ptr<Transport> open_simulated_grbl(std::string_view query) {
    SimGrblOptions options;
    while (!query.empty()) {
        const std::size_t end = std::min(query.find('&'), query.size());
        const std::string_view pair = query.substr(0, end);
        query.remove_prefix(std::min(end + 1, query.size()));
        const std::size_t equals = std::min(pair.find('='), pair.size());
        set_option(pair.substr(0, equals), pair.substr(std::min(equals + 1, pair.size())), options);
    }
    return std::make_unique<SimTransport>(
        std::make_unique<FaultyMachine>(options.machine, options.fault), options.host);
}

}  // namespace leafcutter::drivers
