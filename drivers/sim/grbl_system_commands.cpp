// The `$` lines of the simulated controller, after Grbl 1.1's system.c.

#include <optional>
#include <utility>

#include <fmt/format.h>

#include "drivers/gcode_words.h"
#include "drivers/sim/grbl_machine.h"

namespace leafcutter::drivers {

namespace {

constexpr int kBadNumber = 2;
constexpr int kBadStatement = 3;
constexpr int kHomingOff = 5;
constexpr int kNotIdle = 8;
constexpr int kJogBeyondTravel = 15;
constexpr double kHomingTime = 2.0;  // Seconds; no geometry behind it.

}  // namespace

int GrblMachine::run_system_line(std::string_view line) {
    const char command = line.size() > 1 ? line[1] : '\0';
    switch (command) {
        case '\0':
            out_ += "[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]\r\n";
            return 0;
        case 'J':
            return line.size() > 2 && line[2] == '=' ? jog(line.substr(3)) : jog_state_error();
        case '$':
        case 'G':
        case 'C':
        case 'X':
            return line.size() > 2 ? kBadStatement : run_action_command(command);
        default:
            break;
    }
    if (state_ != State::Idle && state_ != State::Alarm) {
        return kNotIdle;
    }
    return run_storing_command(std::string(line));
}

// Commands that any state may take, or that look at it themselves.
int GrblMachine::run_action_command(char command) {
    switch (command) {
        case '$':
            if (state_ == State::Run || state_ == State::Hold) {
                return kNotIdle;
            }
            out_ += settings_.dump();
            return 0;
        case 'G':
            out_ += interpreter_.report_modal(settings_.is_on(13)) + "\r\n";
            return 0;
        case 'C':
            return toggle_check();
        default:
            if (state_ == State::Alarm) {
                out_ += "[MSG:Caution: Unlocked]\r\n";
                state_ = State::Idle;
            }
            return 0;
    }
}

// Commands that need the machine idle, or locked.
int GrblMachine::run_storing_command(const std::string& line) {
    switch (line[1]) {
        case '#':
            out_ += line.size() > 2 ? "" : interpreter_.report_offsets(settings_.is_on(13));
            return line.size() > 2 ? kBadStatement : 0;
        case 'H':
            return line.size() > 2 && settings_.is_on(22) ? kBadStatement : home();
        case 'S':
            return line == "$SLP" ? sleep() : kBadStatement;
        case 'I':
            return build_info(line);
        case 'R':
            return line.substr(0, 5) == "$RST=" && line.size() == 6 ? restore(line[5])
                                                                    : kBadStatement;
        case 'N':
            return startup_line(line);
        default:
            return set_setting(line);
    }
}

int GrblMachine::sleep() {
    out_ += "ok\r\n[MSG:Sleeping]\r\n";
    line_pending_ = false;
    begin_beam(0.0);
    state_ = State::Sleep;
    return 0;
}

int GrblMachine::build_info(const std::string& line) {
    if (line.size() == 2) {
        out_ += fmt::format("[VER:1.1h.20190830:{}]\r\n[OPT:V,{},{}]\r\n", build_note_,
                            MotionQueue::kCapacity, kRxBytes);
        return 0;
    }
    if (line[2] != '=') {
        return kBadStatement;
    }
    build_note_ = line.substr(3);
    write_eeprom();
    return 0;
}

int GrblMachine::startup_line(const std::string& line) {
    if (line.size() == 2) {
        for (std::size_t i = 0; i < startup_lines_.size(); ++i) {
            out_ += fmt::format("$N{}={}\r\n", i, startup_lines_[i]);
        }
        return 0;
    }
    if (state_ != State::Idle) {
        return kNotIdle;
    }
    std::size_t at = 2;
    const std::optional<double> number = read_decimal(line, at);
    if (!number) {
        return kBadNumber;
    }
    if (at >= line.size() || line[at] != '=') {
        return kBadStatement;
    }
    const std::string text = line.substr(at + 1);
    Interpretation result = interpreter_.run(text, rules());  // It is carried out as well.
    if (result.error != 0) {
        return result.error;
    }
    actions_.insert(actions_.end(), result.actions.begin(), result.actions.end());
    if (*number >= 0.0 && *number < static_cast<double>(startup_lines_.size())) {
        startup_lines_.at(static_cast<std::size_t>(*number)) = text;
    }
    write_eeprom();
    return 0;
}

int GrblMachine::home() {
    if (!settings_.is_on(22)) {
        return kHomingOff;
    }
    actions_.push_back({.kind = Action::Kind::Home, .move = {}, .seconds = kHomingTime});
    return 0;
}

int GrblMachine::toggle_check() {
    if (state_ == State::Check) {
        out_ += "[MSG:Disabled]\r\nok\r\n";
        line_pending_ = false;
        state_ = State::Idle;
        restart();
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
    if (what == '*') {
        build_note_.clear();
        startup_lines_ = {};
    }
    out_ += "[MSG:Restoring defaults]\r\nok\r\n";
    line_pending_ = false;
    restart();
    write_eeprom();
    return 0;
}

int GrblMachine::set_setting(std::string_view line) {
    std::size_t at = 1;
    const std::optional<double> number = read_decimal(line, at);
    if (!number) {
        return kBadNumber;
    }
    if (at >= line.size() || line[at] != '=') {
        return kBadStatement;
    }
    const std::optional<double> value = read_decimal(line, ++at);
    if (!value) {
        return kBadNumber;
    }
    if (at != line.size() || *number > 255.0) {
        return kBadStatement;
    }
    const int error = settings_.set(whole_part(*number), *value);
    if (error == 0) {
        apply_overrides();
        write_eeprom();
        reports_to_offset_ = *number == 13.0 ? 0 : reports_to_offset_;
    }
    return error;
}

int GrblMachine::jog_state_error() const {
    return state_ == State::Idle || state_ == State::Jog ? kBadStatement : kNotIdle;
}

int GrblMachine::jog(std::string_view line) {
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
    const int to_negative = whole_part(settings_.get(23));
    const double pull_off = settings_.get(27);
    Axes position{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double travel = settings_.get(130 + static_cast<int>(axis));
        position[axis] = (to_negative & (1 << axis)) != 0 ? pull_off - travel : -pull_off;
    }
    motion_.set_position(position);
    interpreter_.set_position(position);
    if (std::exchange(status_asked_, false)) {
        out_ += status_report();
    }
    state_ = State::Idle;
    run_startup_lines();
}

}  // namespace leafcutter::drivers
