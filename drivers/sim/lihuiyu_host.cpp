#include "drivers/sim/lihuiyu_host.h"

#include <chrono>
#include <stdexcept>

namespace leafcutter::drivers {

namespace {

using Clock = std::chrono::steady_clock;

// At speed 0 time passes with every word of the sender, or while it is silent for kIdleWait: it
// sees what happens in between, however slow it is.
constexpr std::chrono::milliseconds kBusyWait{1};
constexpr std::chrono::milliseconds kIdleWait{60};

}  // namespace

LihuiyuHost::LihuiyuHost(std::unique_ptr<SimLink> link, const SimLihuiyuOptions& options)
    : link_(std::move(link)),
      address_(link_->address()),
      speed_(options.speed),
      machine_(options.machine) {
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

LihuiyuHost::~LihuiyuHost() {
    thread_.request_stop();
    thread_.join();
    if (burn_file_.is_open()) {
        machine_.beam_log().flush(burn_file_);
    }
}

std::vector<BurntPiece> LihuiyuHost::burnt() const {
    const std::lock_guard lock(mutex_);
    return machine_.beam_log().pieces();
}

bool LihuiyuHost::beam_on() const {
    const std::lock_guard lock(mutex_);
    return machine_.beam_on();
}

std::vector<Violation> LihuiyuHost::take_violations() {
    const std::lock_guard lock(mutex_);
    const auto first =
        machine_.violations().begin() + static_cast<std::ptrdiff_t>(violations_told_);
    violations_told_ = machine_.violations().size();
    return {first, machine_.violations().end()};
}

void LihuiyuHost::run(const std::stop_token& stop) {
    Clock::time_point before = Clock::now();
    while (!stop.stop_requested()) {
        const Clock::time_point now = Clock::now();
        turn(std::chrono::duration<double>(now - before).count());
        before = now;
    }
}

// One look at the wire, and the machine moved on by the time that passed.
void LihuiyuHost::turn(double wall_s) {
    const bool resting = machine_.at_rest();
    const bool hurries = speed_ > 0.0 && !resting;
    const std::string heard = link_->receive(hurries ? kBusyWait : kIdleWait);
    std::string said;
    {
        const std::lock_guard lock(mutex_);
        said = machine_.feed(heard);
        const bool look = !resting || !heard.empty();
        if (speed_ > 0.0) {
            machine_.advance(wall_s * speed_);
        } else if (look) {
            machine_.hurry();
        }
        if (burn_file_.is_open() && !resting && machine_.at_rest()) {
            machine_.beam_log().flush(burn_file_);
        }
    }
    link_->send(said);
    if (machine_.unplugged() && !unplugged_) {
        unplugged_ = true;
        link_->unplug();
    }
}

}  // namespace leafcutter::drivers
