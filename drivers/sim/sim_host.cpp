#include "drivers/sim/sim_host.h"

#include <stdexcept>

namespace leafcutter::drivers {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double kFastStep = 0.02;  // Simulated seconds between looks at the wire at speed 0.
constexpr std::chrono::milliseconds kBusyWait{1};
constexpr std::chrono::milliseconds kIdleWait{20};

}  // namespace

SimHost::SimHost(std::unique_ptr<SimLink> link, const SimHostOptions& options)
    : link_(std::move(link)),
      address_(link_->address()),
      speed_(options.speed),
      machine_(options.machine, options.faults) {
    if (!(speed_ >= 0.0)) {
        throw std::invalid_argument("speed: must be 0 (as fast as possible) or more");
    }
    if (!options.burn_path.empty()) {
        burn_file_.open(options.burn_path, std::ios::trunc);
        if (!burn_file_) {
            throw std::invalid_argument(options.burn_path +
                                        ": the beam log can't be written there");
        }
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

SimHost::~SimHost() {
    thread_.request_stop();
    thread_.join();
    if (burn_file_.is_open()) {
        machine_.machine().beam_log().flush(burn_file_);
    }
}

std::vector<BurntPiece> SimHost::burnt() const {
    const std::lock_guard lock(mutex_);
    return machine_.machine().beam_log().pieces();
}

double SimHost::beam_power() const {
    const std::lock_guard lock(mutex_);
    return machine_.machine().beam_power();
}

void SimHost::run(const std::stop_token& stop) {
    Clock::time_point before = Clock::now();
    while (!stop.stop_requested()) {
        const Clock::time_point now = Clock::now();
        turn(std::chrono::duration<double>(now - before).count());
        before = now;
    }
}

double SimHost::time_to_pass(double wall_s) const {
    if (speed_ > 0.0) {
        return wall_s * speed_;
    }
    return machine_.machine().at_rest() ? 0.0 : kFastStep;
}

// One look at the wire, and the machine moved on by the time that passed.
void SimHost::turn(double wall_s) {
    const bool resting = machine_.machine().at_rest();
    const auto busy_wait = speed_ > 0.0 ? kBusyWait : std::chrono::milliseconds(0);
    const std::string heard = link_->receive(resting ? kIdleWait : busy_wait);
    std::string said;
    {
        const std::lock_guard lock(mutex_);
        said = machine_.feed(heard);
        said += machine_.advance(time_to_pass(wall_s));
        if (burn_file_.is_open() && !resting && machine_.machine().at_rest()) {
            machine_.machine().beam_log().flush(burn_file_);
        }
    }
    link_->send(said);
    if (machine_.unplugged() && !unplugged_) {
        unplugged_ = true;
        link_->unplug();
    }
}

}  // namespace leafcutter::drivers
