#include "drivers/sim/grbl_machine.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace leafcutter::drivers {

namespace {

constexpr std::size_t kLineBytes = 80;  // LINE_BUFFER_SIZE: 79 characters and the end.
constexpr int kLocked = 9;
constexpr int kLineTooLong = 11;
constexpr int kSoftLimitAlarm = 2;

}  // namespace

GrblMachine::GrblMachine(const GrblMachineOptions& options)
    : line_time_s_(options.line_time_s), eeprom_time_s_(options.eeprom_time_s) {
    settings_.set(130, options.bed_width_mm);
    settings_.set(131, options.bed_height_mm);
    apply_overrides();
    greet();
}

std::string GrblMachine::feed(std::string_view bytes) {
    for (const char byte : bytes) {
        receive(byte);
        work();
    }
    return std::exchange(out_, {});
}

std::string GrblMachine::advance(double seconds) {
    const double end_s = now_s_ + seconds;
    work();
    while (now_s_ < end_s) {
        double step = end_s - now_s_;
        if (busy_until_s_ > now_s_) {
            step = std::min(step, busy_until_s_ - now_s_);
        }
        if (alarm_delay_) {
            step = std::min(step, alarm_until_s_ - now_s_);
        }
        const double moved = advance_motion(step);
        const bool stood = motion_.standing() && moved == 0.0;
        now_s_ += stood ? step : moved;
        exposed_since_s_ = stood ? exposed_since_s_ : now_s_;
        if (alarm_delay_ && now_s_ >= alarm_until_s_) {
            end_alarm_delay();
        }
        settle();
        work();
    }
    expose(now_s_);
    return std::exchange(out_, {});
}

double GrblMachine::advance_motion(double seconds) {
    return motion_.standing() ? 0.0 : motion_.advance(seconds, now_s_, log_);
}

bool GrblMachine::at_rest() const {
    const bool waiting = !actions_.empty() && !blocked();
    return motion_.standing() && state_ != State::Jog && busy_until_s_ <= now_s_ && !waiting &&
           !alarm_delay_ && (rx_.empty() || blocked());
}

double GrblMachine::beam_power() const {
    if (state_ == State::Check) {
        return 0.0;
    }
    return motion_.running_power().value_or(standing_power_);
}

// A lit beam that stands still burns too.
void GrblMachine::expose(double until_s) {
    if (standing_power_ > 0.0 && motion_.standing() && until_s > exposed_since_s_) {
        const Axes& at = motion_.position_mm();
        const Axes offset = interpreter_.work_offset_mm();
        BurntPiece piece;
        piece.t0_s = exposed_since_s_;
        piece.t1_s = until_s;
        piece.x0_mm = piece.x1_mm = at[0] - offset[0];
        piece.y0_mm = piece.y1_mm = at[1] - offset[1];
        piece.s = piece.s_mean = standing_power_;
        log_.add(piece);
    }
    exposed_since_s_ = until_s;
}

// What follows from having come to a stand.
void GrblMachine::settle() {
    if (!motion_.standing()) {
        return;
    }
    if (soft_limit_) {
        soft_limit_ = false;
        owes_answer_ = line_pending_;
        clear_all();
        set_alarm(kSoftLimitAlarm);
    } else if (jog_flush_) {
        jog_flush_ = false;
        motion_.clear(now_s_, log_);
        interpreter_.set_position(motion_.position_mm());
        actions_.clear();
        state_ = std::exchange(door_after_jog_, false) ? State::Door : State::Idle;
    } else if (state_ == State::Hold || state_ == State::Door) {
        settle_hold();
    } else if (motion_.empty() && (state_ == State::Run || state_ == State::Jog)) {
        state_ = State::Idle;
    }
    if (state_ == State::Home && busy_until_s_ <= now_s_) {
        finish_home();
    }
}

// A hold that has come to a stand puts the beam out, in laser mode; a door always does.
void GrblMachine::settle_hold() {
    const bool lit_mode = interpreter_.beam() != BeamMode::Off;
    const bool stops = state_ == State::Door || (settings_.is_on(32) && lit_mode);
    if (stops && !beam_stopped_) {
        begin_beam(0.0);
        beam_stopped_ = true;
    }
}

// The power that holds while standing, from now on.
void GrblMachine::begin_beam(double power_s) {
    expose(now_s_);
    standing_power_ = power_s;
    reports_to_override_ = 0;
}

// The firmware can't receive while it writes.
void GrblMachine::write_eeprom() {
    deaf_until_s_ = now_s_ + eeprom_time_s_;
    busy_until_s_ = std::max(busy_until_s_, deaf_until_s_);
}

// Nothing may be read or begun now; real-time bytes still act.
bool GrblMachine::blocked() const {
    return critical_ || alarm_delay_ || soft_limit_ || jog_flush_ || state_ == State::Hold ||
           state_ == State::Door || state_ == State::Sleep || state_ == State::Home;
}

// The main loop of the firmware, as far as it gets without time passing.
void GrblMachine::work() {
    while (!blocked() && busy_until_s_ <= now_s_) {
        if (!actions_.empty()) {
            const Action action = actions_.front();
            if (!perform(action)) {
                return;
            }
            if (!actions_.empty()) {
                actions_.pop_front();
            }
        } else if (line_pending_) {
            answer(0);
        } else if (!rx_.empty()) {
            const char byte = rx_.front();
            rx_.pop_front();
            take_byte(byte);
        } else {
            return;
        }
    }
}

// Returns false while the action must wait, and is to be tried again later.
bool GrblMachine::perform(const Action& action) {
    if (action.kind == Action::Kind::Move) {
        return perform_move(action);
    }
    if (action.kind == Action::Kind::Offset) {
        reports_to_offset_ = 0;
        return true;
    }
    if (state_ == State::Check) {
        return true;
    }
    if (!motion_.empty()) {
        return false;
    }
    switch (action.kind) {
        case Action::Kind::Beam:
            begin_beam(motion_.overrides().put_out(action.move.power_s));
            break;
        case Action::Kind::Sync:
            reports_to_override_ = 0;
            break;
        case Action::Kind::Dwell:
            busy_until_s_ = now_s_ + action.seconds;
            break;
        case Action::Kind::Pause:
            feed_hold();
            break;
        case Action::Kind::End:
            override_percent_ = {100, 100, 100};
            apply_overrides();
            reports_to_override_ = reports_to_offset_ = 0;
            out_ += "[MSG:Pgm End]\r\n";
            break;
        case Action::Kind::Home:
            state_ = State::Home;
            busy_until_s_ = now_s_ + action.seconds;
            break;
        default:
            break;
    }
    return true;
}

bool GrblMachine::perform_move(const Action& action) {
    if (settings_.is_on(20) && state_ != State::Jog && beyond_travel(action.move.target_mm)) {
        soft_limit_ = true;
        actions_.clear();
        motion_.hold();
        settle();
        return true;
    }
    if (state_ == State::Check) {
        return true;
    }
    if (motion_.full()) {
        return false;
    }
    expose(now_s_);
    if (motion_.push(action.move, limits())) {
        const bool stays_lit = action.move.beam != BeamMode::Off && !action.move.scale_power;
        standing_power_ = stays_lit ? motion_.overrides().put_out(action.move.power_s) : 0.0;
        state_ = state_ == State::Idle ? State::Run : state_;
    } else if (action.move.beam == BeamMode::Constant && settings_.is_on(32)) {
        // Grbl 1.1 motion_control.c: a move of no length still sets the power of a constant beam.
        if (!motion_.empty()) {
            return false;
        }
        begin_beam(motion_.overrides().put_out(action.move.power_s));
    }
    return true;
}

void GrblMachine::take_byte(char byte) {
    if (byte == '\n' || byte == '\r') {
        run_line();
        return;
    }
    if (skip_to_end_ || in_comment_) {
        in_comment_ = in_comment_ && byte != ')';
        return;
    }
    if (static_cast<unsigned char>(byte) <= ' ' || byte == '/') {
        return;
    }
    if (byte == '(' || byte == ';') {
        in_comment_ = byte == '(';
        skip_to_end_ = byte == ';';
    } else if (line_.size() >= kLineBytes - 1) {
        line_overflow_ = true;
    } else {
        const bool lower = byte >= 'a' && byte <= 'z';
        line_ += lower ? static_cast<char>(byte - 'a' + 'A') : byte;
    }
}

void GrblMachine::run_line() {
    const std::string line = std::exchange(line_, {});
    in_comment_ = skip_to_end_ = false;
    busy_until_s_ = std::max(busy_until_s_, now_s_ + line_time_s_);
    line_pending_ = true;
    pending_is_gcode_ = !line.empty() && line[0] != '$';
    if (std::exchange(line_overflow_, false)) {
        answer(kLineTooLong);
    } else if (line.empty()) {
        answer(0);
    } else if (line[0] == '$') {
        const int error = run_system_line(line);
        if (error != 0 || (actions_.empty() && line_pending_)) {
            answer(error);
        }
    } else if (state_ == State::Alarm || state_ == State::Jog) {
        answer(kLocked);
    } else {
        Interpretation result = interpreter_.run(line, rules());
        if (result.writes_eeprom) {
            write_eeprom();
        }
        if (result.error != 0) {
            answer(result.error);
        }
        actions_.assign(result.actions.begin(), result.actions.end());
    }
}

void GrblMachine::answer(int error) {
    out_ += error == 0 ? "ok\r\n" : fmt::format("error:{}\r\n", error);
    line_pending_ = false;
    gcode_lines_ += pending_is_gcode_ ? 1 : 0;
    pending_is_gcode_ = false;
}

GcodeInterpreter::Rules GrblMachine::rules() const {
    return {settings_.is_on(32), settings_.get(12), settings_.axes(100)};
}

MotionLimits GrblMachine::limits() const {
    MotionLimits limits;
    limits.max_mm_per_s = settings_.axes(110);
    for (double& speed : limits.max_mm_per_s) {
        speed /= 60.0;
    }
    limits.acceleration = settings_.axes(120);
    limits.junction_deviation_mm = settings_.get(11);
    return limits;
}

void GrblMachine::apply_overrides() {
    const auto part = [this](std::size_t which) { return override_percent_[which] / 100.0; };
    motion_.set_overrides({part(0), part(1), part(2), settings_.get(31), settings_.get(30)}, now_s_,
                          log_);
}

}  // namespace leafcutter::drivers
