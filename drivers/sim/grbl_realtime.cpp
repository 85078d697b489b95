// The simulated controller's receiving interrupt and its real-time commands.

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "drivers/gcode_words.h"
#include "drivers/sim/grbl_machine.h"

namespace leafcutter::drivers {

namespace {

constexpr unsigned char kReset = 0x18;
constexpr unsigned char kDoor = 0x84;
constexpr unsigned char kJogCancel = 0x85;
constexpr unsigned char kFirstOverride = 0x90;
constexpr unsigned char kLastOverride = 0x9D;
constexpr unsigned char kStopBeam = 0x9E;

}  // namespace

void GrblMachine::receive(char byte) {
    const auto code = static_cast<unsigned char>(byte);
    if (now_s_ < deaf_until_s_) {
        ++bytes_dropped_;
    } else if (code == kReset || code == '?' || code == '!' || code == '~' || code > 0x7F) {
        realtime(code);
    } else if (rx_.size() < kRxBytes) {
        rx_.push_back(byte);
    } else {
        ++bytes_dropped_;
    }
}

void GrblMachine::realtime(unsigned char byte) {
    if (byte == kReset) {
        soft_reset();
        return;
    }
    if (critical_ || alarm_delay_) {
        return;
    }
    switch (byte) {
        case '?':
            if (state_ == State::Home) {
                status_asked_ = true;
            } else {
                out_ += status_report();
            }
            break;
        case '!':
            feed_hold();
            break;
        case '~':
            cycle_start();
            break;
        case kDoor:
            safety_door();
            break;
        case kJogCancel:
            jog_cancel();
            break;
        case kStopBeam:
            toggle_stopped_beam();
            break;
        default:
            if (byte >= kFirstOverride && byte <= kLastOverride) {
                adjust_override(byte);
            }
            break;
    }
}

void GrblMachine::feed_hold() {
    if (state_ == State::Jog) {
        jog_cancel();
    } else if (state_ == State::Idle || state_ == State::Run) {
        state_ = State::Hold;
        held_since_s_ = now_s_;
        motion_.hold();
        settle();
    }
}

void GrblMachine::cycle_start() {
    const bool held = state_ == State::Hold || state_ == State::Door;
    if (!held || !motion_.standing()) {
        return;  // While slowing down it is ignored, as by the real one.
    }
    if (std::exchange(beam_stopped_, false) && state_ == State::Hold) {
        out_ += "[MSG:Restoring spindle]\r\n";
    }
    motion_.release();
    const double rest_s = busy_until_s_ - held_since_s_;
    busy_until_s_ = rest_s > 0.0 ? now_s_ + rest_s : busy_until_s_;
    state_ = motion_.empty() ? State::Idle : State::Run;
    work();
}

void GrblMachine::safety_door() {
    if (state_ == State::Alarm || state_ == State::Check) {
        return;
    }
    out_ += "[MSG:Check Door]\r\n";
    if (state_ == State::Jog) {
        door_after_jog_ = true;
        jog_cancel();
    } else if (state_ != State::Sleep && state_ != State::Door && state_ != State::Home) {
        state_ = State::Door;
        held_since_s_ = now_s_;
        beam_stopped_ = false;
        motion_.hold();
        settle();
    }
}

// 0x9E: puts the beam out during a hold, or lights a constant one again.
void GrblMachine::toggle_stopped_beam() {
    if (state_ != State::Hold || !motion_.standing() || interpreter_.beam() == BeamMode::Off) {
        return;
    }
    beam_stopped_ = !beam_stopped_;
    if (!beam_stopped_) {
        out_ += "[MSG:Restoring spindle]\r\n";
    }
    const bool lit =
        !beam_stopped_ && (interpreter_.beam() == BeamMode::Constant || !settings_.is_on(32));
    begin_beam(lit ? motion_.overrides().put_out(interpreter_.spindle_speed()) : 0.0);
}

void GrblMachine::jog_cancel() {
    if (state_ == State::Jog) {
        jog_flush_ = true;
        motion_.hold();
        settle();
    }
}

void GrblMachine::adjust_override(unsigned char byte) {
    constexpr std::array<int, 5> kSteps{0, 10, -10, 1, -1};
    constexpr std::array<int, 3> kRapids{100, 50, 25};
    const std::array<int, 3> before = override_percent_;
    const auto step = [&](int& percent, unsigned char first) {
        const int change = kSteps.at(static_cast<std::size_t>(byte - first));
        percent = change == 0 ? 100 : std::clamp(percent + change, 10, 200);
    };
    if (byte <= 0x94) {
        step(override_percent_[0], 0x90);
    } else if (byte <= 0x97) {
        override_percent_[1] = kRapids.at(static_cast<std::size_t>(byte - 0x95));
    } else if (byte >= 0x99) {
        step(override_percent_[2], 0x99);
    }
    if (override_percent_ != before) {
        reports_to_override_ = 0;
        apply_overrides();
    }
}

namespace {

std::string state_name(GrblMachine::State state, bool standing) {
    switch (state) {
        case GrblMachine::State::Idle:
            return "Idle";
        case GrblMachine::State::Run:
            return "Run";
        case GrblMachine::State::Hold:
            return standing ? "Hold:0" : "Hold:1";
        case GrblMachine::State::Jog:
            return "Jog";
        case GrblMachine::State::Home:
            return "Home";
        case GrblMachine::State::Alarm:
            return "Alarm";
        case GrblMachine::State::Door:
            return standing ? "Door:0" : "Door:2";
        case GrblMachine::State::Check:
            return "Check";
        case GrblMachine::State::Sleep:
            return "Sleep";
    }
    return "Idle";
}

}  // namespace

std::string GrblMachine::status_report() {
    const int mask = whole_part(settings_.get(10));
    const double unit = settings_.is_on(13) ? 1.0 / 25.4 : 1.0;
    const int digits = settings_.is_on(13) ? 4 : 3;
    const bool machine_frame = (mask & 1) != 0;
    const Axes offset = interpreter_.work_offset_mm();
    const auto triple = [&](const Axes& mm) {
        return fmt::format("{:.{}f},{:.{}f},{:.{}f}", mm[0] * unit, digits, mm[1] * unit, digits,
                           mm[2] * unit, digits);
    };
    Axes shown = motion_.position_mm();
    for (std::size_t axis = 0; axis < 3 && !machine_frame; ++axis) {
        shown[axis] -= offset[axis];
    }
    std::string text = fmt::format("<{}|{}:{}", state_name(state_, motion_.standing()),
                                   machine_frame ? "MPos" : "WPos", triple(shown));
    if ((mask & 2) != 0) {
        text += fmt::format("|Bf:{},{}", MotionQueue::kCapacity - motion_.size(),
                            kRxBytes - rx_.size());
    }
    text += fmt::format("|FS:{:.{}f},{:.0f}", motion_.speed_mm_per_s() * 60.0 * unit, digits - 3,
                        beam_power());
    // Offset and overrides come now and then, never in the same report.
    const bool busy = state_ != State::Idle && state_ != State::Alarm && state_ != State::Check &&
                      state_ != State::Sleep;
    if (reports_to_offset_ > 0) {
        --reports_to_offset_;
    } else {
        reports_to_offset_ = busy ? 29 : 9;
        reports_to_override_ = std::max(reports_to_override_, 1);
        text += fmt::format("|WCO:{}", triple(offset));
    }
    if (reports_to_override_ > 0) {
        --reports_to_override_;
    } else {
        reports_to_override_ = busy ? 19 : 9;
        text += fmt::format("|Ov:{},{},{}", override_percent_[0], override_percent_[1],
                            override_percent_[2]);
        const bool lit = beam_power() > 0.0;
        if (lit || interpreter_.flood()) {
            text += fmt::format("|A:{}{}",
                                !lit ? "" : (interpreter_.beam() == BeamMode::Dynamic ? "C" : "S"),
                                interpreter_.flood() ? "F" : "");
        }
    }
    return text + ">\r\n";
}

}  // namespace leafcutter::drivers
