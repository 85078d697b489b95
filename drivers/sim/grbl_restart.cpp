// How the simulated controller stops for an alarm, and how it starts again.

#include <utility>

#include <fmt/format.h>

#include "drivers/sim/grbl_machine.h"

namespace leafcutter::drivers {

namespace {

constexpr double kAlarmDelay = 0.5;  // Seconds; report.c waits so that the message gets out.

}  // namespace

void GrblMachine::set_alarm(int code) {
    state_ = State::Alarm;
    critical_ = code == 1 || code == 2;
    alarm_delay_ = true;
    alarm_until_s_ = now_s_ + kAlarmDelay;
    out_ += fmt::format("ALARM:{}\r\n", code);
}

void GrblMachine::end_alarm_delay() {
    alarm_delay_ = false;
    if (critical_) {
        out_ += "[MSG:Reset to continue]\r\n";
    } else if (restarting_) {
        restart();
    }
}

// What every reset forgets; the machine's position stays.
void GrblMachine::clear_all() {
    if (motion_.standing()) {
        expose(now_s_);
    }
    motion_.clear(now_s_, log_);
    standing_power_ = 0.0;
    rx_.clear();
    line_.clear();
    line_overflow_ = in_comment_ = skip_to_end_ = false;
    actions_.clear();
    line_pending_ = pending_is_gcode_ = false;
    busy_until_s_ = now_s_;
    soft_limit_ = jog_flush_ = critical_ = alarm_delay_ = restarting_ = false;
    beam_stopped_ = door_after_jog_ = status_asked_ = false;
    override_percent_ = {100, 100, 100};
    apply_overrides();
    reports_to_offset_ = 0;
    reports_to_override_ = 0;
    interpreter_.reset(motion_.position_mm());
}

// The end of a reset. What came in since its beginning is lost.
void GrblMachine::restart() {
    if (std::exchange(owes_answer_, false)) {
        out_ += "ok\r\n";
    }
    const bool locked = state_ == State::Alarm || state_ == State::Sleep;
    clear_all();
    state_ = locked ? State::Alarm : State::Idle;
    greet();
}

void GrblMachine::greet() {
    out_ += "\r\nGrbl 1.1h ['$' for help]\r\n";
    if (state_ == State::Alarm) {
        out_ += "[MSG:'$H'|'$X' to unlock]\r\n";
    } else {
        run_startup_lines();
    }
}

void GrblMachine::run_startup_lines() {
    for (const std::string& line : startup_lines_) {
        if (line.empty()) {
            continue;
        }
        Interpretation result = interpreter_.run(line, rules());
        actions_.insert(actions_.end(), result.actions.begin(), result.actions.end());
        out_ += result.error == 0 ? fmt::format(">{}:ok\r\n", line)
                                  : fmt::format(">{}:error:{}\r\n", line, result.error);
    }
}

void GrblMachine::soft_reset() {
    if (alarm_delay_) {
        return;  // Lost on the way to an alarm's lock, and nothing new during a reset.
    }
    const bool homing = state_ == State::Home;
    const bool moving = !motion_.standing() || homing;
    expose(now_s_);
    owes_answer_ = owes_answer_ || line_pending_;
    if (!moving) {
        restart();
        return;
    }
    clear_all();
    constexpr int kResetWhileMoving = 3;
    constexpr int kResetWhileHoming = 6;
    set_alarm(homing ? kResetWhileHoming : kResetWhileMoving);
    restarting_ = true;
}

void GrblMachine::trip_hard_limit() {
    owes_answer_ = line_pending_;
    clear_all();
    set_alarm(1);
}

void GrblMachine::power_cycle() {
    clear_all();
    owes_answer_ = false;
    deaf_until_s_ = 0.0;
    motion_.set_position({});
    interpreter_ = GcodeInterpreter{};
    state_ = settings_.is_on(22) ? State::Alarm : State::Idle;
    greet();
}

}  // namespace leafcutter::drivers
