// The `$` lines of the simulated controller, after Grbl 1.1's system.c.

#include <charconv>

#include <fmt/format.h>

#include "drivers/gcode_words.h"
#include "drivers/sim/grbl_machine.h"

namespace leafcutter::drivers {

namespace {

constexpr int kBadNumber = 2;
constexpr int kBadStatement = 3;
constexpr int kHomingOff = 5;
constexpr int kNotIdle = 8;
constexpr int kLocked = 9;
constexpr int kJogBeyondTravel = 15;
constexpr double kHomingTime = 2.0;  // Seconds; no geometry behind it.

}  // namespace

int GrblMachine::run_system_line(std::string_view line) {
    if (line.substr(0, 3) == "$J=") {
        return jog(line.substr(3));
    }
    if (line.size() <= 2) {
        const int error = run_report_command(line);
        return error == kBadStatement ? run_action_command(line) : error;
    }
    if (state_ != State::Idle && state_ != State::Alarm) {
        return kNotIdle;
    }
    if (line == "$SLP") {
        clear_all();
        state_ = State::Sleep;
        out_ += "[MSG:Sleeping]\r\nok\r\n";
        return 0;
    }
    if (line.substr(0, 5) == "$RST=" && line.size() == 6) {
        return restore(line[5]);
    }
    if (line.substr(0, 3) == "$I=" || line.substr(0, 2) == "$N") {
        return 0;  // Accepted; a simulated machine keeps no build note and no startup line.
    }
    return set_setting(line);
}

int GrblMachine::run_report_command(std::string_view line) {
    const bool at_rest = state_ == State::Idle || state_ == State::Alarm;
    if (line == "$") {
        out_ += "[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]\r\n";
        return 0;
    }
    if (line == "$G") {
        out_ += interpreter_.report_modal() + "\r\n";
        return 0;
    }
    if (line == "$$") {
        if (state_ == State::Run || state_ == State::Hold) {
            return kNotIdle;
        }
        out_ += settings_.dump();
        return 0;
    }
    if (line != "$#" && line != "$I" && line != "$N") {
        return kBadStatement;
    }
    if (!at_rest) {
        return kNotIdle;
    }
    if (line == "$#") {
        out_ += interpreter_.report_offsets();
    } else if (line == "$I") {
        out_ += fmt::format("[VER:1.1h.20190825:]\r\n[OPT:V,{},{}]\r\n", MotionQueue::kCapacity,
                            kRxBytes);
    } else {
        out_ += "$N0=\r\n$N1=\r\n";
    }
    return 0;
}

int GrblMachine::run_action_command(std::string_view line) {
    if (line == "$X") {
        if (state_ == State::Alarm) {
            out_ += "[MSG:Caution: Unlocked]\r\n";
            state_ = State::Idle;
        }
        return 0;
    }
    if (line == "$C") {
        return toggle_check();
    }
    if (line != "$H") {
        return kBadStatement;
    }
    if (!settings_.is_on(22)) {
        return kHomingOff;
    }
    if (state_ != State::Idle && state_ != State::Alarm) {
        return kNotIdle;
    }
    actions_.push_back({.kind = Action::Kind::Home, .move = {}, .seconds = kHomingTime});
    return 0;
}

int GrblMachine::toggle_check() {
    if (state_ == State::Check) {
        out_ += "[MSG:Disabled]\r\nok\r\n";
        clear_all();
        state_ = State::Idle;
        greet();
        return 0;
    }
    if (state_ != State::Idle) {
        return kNotIdle;
    }
    state_ = State::Check;
    out_ += "[MSG:Enabled]\r\n";
    return 0;
}

int GrblMachine::restore(char what) {
    if (what != '$' && what != '#' && what != '*') {
        return kBadStatement;
    }
    if (what != '#') {
        settings_ = GrblSettings{};
    }
    if (what != '$') {
        interpreter_ = GcodeInterpreter{};
    }
    out_ += "[MSG:Restoring defaults]\r\nok\r\n";
    clear_all();
    greet();
    return 0;
}

int GrblMachine::set_setting(std::string_view line) {
    const std::size_t equals = line.find('=');
    int number = 0;
    const char* const digits = line.data() + 1;
    if (equals == std::string_view::npos) {
        return kBadStatement;
    }
    const auto [end, fault] = std::from_chars(digits, line.data() + equals, number);
    if (fault != std::errc{} || end != line.data() + equals) {
        return kBadStatement;
    }
    double value = 0.0;
    const auto [value_end, value_fault] = std::from_chars(
        line.data() + equals + 1, line.data() + line.size(), value, std::chars_format::fixed);
    if (value_fault != std::errc{} || value_end != line.data() + line.size()) {
        return kBadNumber;
    }
    return settings_.set(number, value);
}

int GrblMachine::jog(std::string_view line) {
    if (state_ == State::Alarm) {
        return kLocked;
    }
    if (state_ != State::Idle && state_ != State::Jog) {
        return kNotIdle;
    }
    const GcodeInterpreter before = interpreter_;
    Interpretation result = interpreter_.run_jog(line, rules());
    if (result.error != 0) {
        return result.error;
    }
    for (const Action& action : result.actions) {
        if (settings_.is_on(20) && beyond_travel(action.move.target_mm)) {
            interpreter_ = before;
            return kJogBeyondTravel;
        }
    }
    state_ = State::Jog;
    actions_.assign(result.actions.begin(), result.actions.end());
    return 0;
}

// Without HOMING_FORCE_SET_ORIGIN the whole travel lies on the negative side.
bool GrblMachine::beyond_travel(const Axes& target_mm) const {
    const Axes travel = settings_.axes(130);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (target_mm[axis] > 0.0 || target_mm[axis] < -travel[axis]) {
            return true;
        }
    }
    return false;
}

void GrblMachine::finish_home() {
    const int to_negative = static_cast<int>(settings_.get(23));
    const double pull_off = settings_.get(27);
    Axes position{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double travel = settings_.get(130 + static_cast<int>(axis));
        position[axis] = (to_negative & (1 << axis)) != 0 ? pull_off - travel : -pull_off;
    }
    motion_.set_position(position);
    interpreter_.set_position(position);
    state_ = State::Idle;
}

}  // namespace leafcutter::drivers
