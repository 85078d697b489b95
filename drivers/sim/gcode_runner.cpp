#include "drivers/sim/gcode_runner.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace leafcutter::drivers {

namespace {

constexpr MotionLimits kLimits{{200.0, 200.0, 10.0}, {1000.0, 1000.0, 100.0}, 0.01};
constexpr GcodeInterpreter::Rules kRules{true, 0.01, {80.0, 80.0, 80.0}};
constexpr double kHomeMmPerS = 50.0;

}  // namespace

int GcodeRunner::begin(const std::string& stripped) {
    Interpretation read = interpreter_.run(stripped, kRules);
    actions_.assign(read.actions.begin(), read.actions.end());
    return read.error;
}

void GcodeRunner::home() {
    waits_for_stand_ = homes_ = true;
}

bool GcodeRunner::perform(const Action& action) {
    switch (action.kind) {
        case Action::Kind::Move:
            if (motion_.full()) {
                return false;
            }
            motion_.push(action.move, kLimits);
            return true;
        case Action::Kind::Beam:
        case Action::Kind::Offset:
            return true;
        case Action::Kind::Dwell:
            if (motion_.empty()) {
                busy_until_s_ = now_s_ + action.seconds;
            }
            return motion_.empty();
        default:
            return motion_.empty();
    }
}

bool GcodeRunner::work() {
    while (busy_until_s_ <= now_s_ && !actions_.empty() && perform(actions_.front())) {
        actions_.pop_front();
    }
    if (waits_for_stand_ && motion_.empty()) {
        waits_for_stand_ = false;
        if (std::exchange(homes_, false)) {
            const Axes& at = motion_.position_mm();
            busy_until_s_ = now_s_ + 0.1 + std::hypot(at[0], at[1]) / kHomeMmPerS;
            motion_.set_position({});
            interpreter_.set_position({});
        }
    }
    return actions_.empty() && !waiting();
}

double GcodeRunner::advance(double seconds) {
    double step = seconds;
    if (busy_until_s_ > now_s_) {
        step = std::min(step, busy_until_s_ - now_s_);
    }
    if (!motion_.empty()) {
        const double used = motion_.advance(step, now_s_, log_);
        step = used > 0.0 ? used : step;
    }
    now_s_ += step;
    return step;
}

void GcodeRunner::drop_planned() {
    motion_.clear(now_s_, log_);
    interpreter_.set_position(motion_.position_mm());
}

void GcodeRunner::drop_line() {
    actions_.clear();
    waits_for_stand_ = homes_ = false;
    busy_until_s_ = now_s_;
    interpreter_.set_position(motion_.position_mm());
}

void GcodeRunner::scale_power(double factor) {
    motion_.set_overrides({1.0, 1.0, factor}, now_s_, log_);
}

}  // namespace leafcutter::drivers
