#include "drivers/sim/sim_host.h"

#include <stdexcept>
#include <utility>

namespace leafcutter::drivers {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kBusyWait{1};
constexpr milliseconds kIdleWait{20};
constexpr milliseconds kQuestionWait{60};

}  // namespace

std::ofstream open_burn_file(const std::string& path) {
    std::ofstream file;
    if (!path.empty()) {
        file.open(path, std::ios::trunc);
        if (!file) {
            throw std::invalid_argument(path + ": the beam log can't be written there");
        }
    }
    return file;
}

SimHost::SimHost(std::unique_ptr<SimLink> link,
                 std::unique_ptr<SimMachine> machine,
                 const SimHostOptions& options)
    : link_(std::move(link)),
      address_(link_->address()),
      speed_(options.speed),
      keep_burnt_(options.keep_burnt),
      burn_file_(open_burn_file(options.burn_path)),
      machine_(std::move(machine)) {
    if (!(speed_ >= 0.0)) {
        throw std::invalid_argument("speed: must be 0 (as fast as possible) or more");
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

SimHost::~SimHost() {
    thread_.request_stop();
    thread_.join();
    if (burn_file_.is_open()) {
        machine_->beam_log().flush(burn_file_);
    }
}

std::vector<BurntPiece> SimHost::burnt() const {
    const std::lock_guard lock(mutex_);
    return std::as_const(*machine_).beam_log().pieces();
}

double SimHost::beam_power() const {
    const std::lock_guard lock(mutex_);
    return machine_->beam_power();
}

std::vector<Violation> SimHost::take_violations() {
    const std::lock_guard lock(mutex_);
    return machine_->take_violations();
}

void SimHost::run(const std::stop_token& stop) {
    Clock::time_point before = Clock::now();
    while (!stop.stop_requested()) {
        const Clock::time_point now = Clock::now();
        turn(std::chrono::duration<double>(now - before).count());
        before = now;
    }
}

milliseconds SimHost::wait_for_bytes() const {
    if (machine_->at_rest()) {
        return kIdleWait;
    }
    if (speed_ > 0.0) {
        return kBusyWait;
    }
    return machine_->waits_for_questions() ? kQuestionWait : milliseconds(0);
}

// Written while the machine rests, or when there is much of it.
void SimHost::keep_log() {
    constexpr std::size_t kMuch = 10000;
    BeamLog& log = machine_->beam_log();
    const bool drop = !keep_burnt_ && log.pieces().size() >= kMuch;
    if (burn_file_.is_open() && (machine_->at_rest() || drop)) {
        log.flush(burn_file_);
    }
    if (drop) {
        log.forget();
    }
}

// One look at the wire, and the machine moved on by the time that passed.
void SimHost::turn(double wall_s) {
    const bool resting = machine_->at_rest();
    const std::string heard = link_->receive(wait_for_bytes());
    std::string said;
    {
        const std::lock_guard lock(mutex_);
        said = machine_->feed(heard);
        if (speed_ > 0.0) {
            said += machine_->advance(wall_s * speed_);
        } else if (!resting || !heard.empty()) {
            said += machine_->hurry();
        }
        keep_log();
    }
    link_->send(said);
    if (machine_->unplugged() && !unplugged_) {
        unplugged_ = true;
        link_->unplug();
    }
}

}  // namespace leafcutter::drivers
