#include "drivers/sim/gcode_interpreter.h"

#include <cmath>

#include <fmt/format.h>

#include "drivers/sim/gcode_block.h"

namespace leafcutter::drivers {

namespace {

constexpr double kMmPerInch = 25.4;

double to_steps(double mm, double steps_per_mm) {
    return steps_per_mm > 0.0 ? std::round(mm * steps_per_mm) / steps_per_mm : mm;
}

bool is_burning_motion(GcodeInterpreter::Motion motion) {
    return motion == GcodeInterpreter::Motion::Linear ||
           motion == GcodeInterpreter::Motion::ArcCw || motion == GcodeInterpreter::Motion::ArcCcw;
}

}  // namespace

Interpretation GcodeInterpreter::run(std::string_view stripped, const Rules& rules) {
    Interpretation result;
    Block block;
    result.error = read_words(stripped, block);
    if (result.error == 0) {
        result.error = check(block);
    }
    if (result.error == 0) {
        const int code = block.non_modal.value_or(0);
        result.writes_eeprom = code == 10 || code == 281 || code == 301;
        execute(block, rules, result.actions);
    }
    return result;
}

Interpretation GcodeInterpreter::run_jog(std::string_view stripped, const Rules& rules) {
    Interpretation result;
    Block block;
    block.jog = true;
    result.error = read_words(stripped, block);
    if (result.error == 0 && !block.feed) {
        result.error = grbl_error::kUndefinedFeed;
    }
    if (result.error == 0) {
        result.error = check(block);
    }
    if (result.error == 0 && (block.s || block.t)) {
        result.error = grbl_error::kUnusedWords;
    }
    if (result.error == 0 && (block.not_for_jog || (block.non_modal && *block.non_modal != 53))) {
        result.error = grbl_error::kBadJog;
    }
    if (result.error == 0) {
        // Without an axis word the target is machine zero: so does the firmware.
        const Axes target = block.any_axis() ? block.target_mm : Axes{};
        block.modal.power_s = modal_.power_s;
        add_line(block, rules, target, result.actions);
    }
    return result;
}

void GcodeInterpreter::reset(const Axes& position_mm) {
    modal_ = Modal{};
    g92_mm_ = Axes{};
    tool_length_mm_ = 0.0;
    position_mm_ = position_mm;
}

Axes GcodeInterpreter::work_offset_mm() const {
    Axes offset = coordinates_.at(modal_.coordinates);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        offset[axis] += g92_mm_[axis];
    }
    offset[2] += tool_length_mm_;
    return offset;
}

int GcodeInterpreter::check(Block& block) {
    const bool motion_line =
        block.moves() || (block.motion_word && *block.motion_word != Motion::None);
    constexpr double kMostLines = 10000000.0;
    if (block.line_number && *block.line_number > kMostLines) {
        return grbl_error::kLineNumber;
    }
    const double unit = block.modal.inches ? kMmPerInch : 1.0;
    if (block.modal.inverse_time) {
        const bool needs = motion_line && block.modal.motion != Motion::Rapid && block.any_axis();
        if (needs && !block.feed) {
            return grbl_error::kUndefinedFeed;
        }
        block.modal.feed_mm_per_min = block.feed.value_or(0.0);
    } else if (block.feed) {
        block.modal.feed_mm_per_min = *block.feed * unit;
    } else if (modal_.inverse_time && !block.jog) {
        block.modal.feed_mm_per_min = 0.0;
    }
    block.modal.power_s = block.s.value_or(modal_.power_s);
    block.modal.tool = whole_part(block.t.value_or(modal_.tool));
    if (block.tool_offset == 43 &&
        !(block.axis_given[2] && !block.axis_given[0] && !block.axis_given[1])) {
        return grbl_error::kToolOffsetAxis;
    }
    if (const int error = check_non_modal(block)) {
        return error;
    }
    resolve_target(block);
    return check_motion(block, motion_line);
}

int GcodeInterpreter::check_non_modal(const Block& block) const {
    const int code = block.non_modal.value_or(0);
    if (code == 4 && !block.p) {
        return grbl_error::kValueMissing;
    }
    if (code == 10) {
        if (!block.any_axis()) {
            return grbl_error::kNoAxisWords;
        }
        if (!block.p && !block.l) {
            return grbl_error::kValueMissing;
        }
        constexpr double kMostSystems = 6.0;
        if (block.p.value_or(0.0) > kMostSystems) {
            return grbl_error::kCoordinateSystem;
        }
        const double l = std::trunc(block.l.value_or(0.0));
        if ((l != 2.0 && l != 20.0) || (l == 2.0 && block.r)) {
            return grbl_error::kUnsupported;
        }
    }
    if (code == 92 && !block.any_axis()) {
        return grbl_error::kNoAxisWords;
    }
    if (code == 53 && block.modal.motion != Motion::Rapid && block.modal.motion != Motion::Linear) {
        return grbl_error::kG53Motion;
    }
    return 0;
}

int GcodeInterpreter::check_motion(Block& block, bool motion_line) const {
    if (block.modal.motion == Motion::None && block.any_axis()) {
        return grbl_error::kAxisWordsExist;
    }
    if (motion_line && block.modal.motion != Motion::Rapid && block.modal.feed_mm_per_min == 0.0) {
        return grbl_error::kUndefinedFeed;
    }
    const bool arc = motion_line &&
                     (block.modal.motion == Motion::ArcCw || block.modal.motion == Motion::ArcCcw);
    if (arc) {
        if (const int error = check_arc(block)) {
            return error;
        }
    }
    const bool offsets = block.offset_given[0] || block.offset_given[1] || block.offset_given[2];
    const int code = block.non_modal.value_or(0);
    const bool unused = (block.p && code != 4 && code != 10) || (block.l && code != 10) ||
                        (!arc && (offsets || block.r));
    return unused ? grbl_error::kUnusedWords : 0;
}

void GcodeInterpreter::resolve_target(Block& block) const {
    const double unit = block.modal.inches ? kMmPerInch : 1.0;
    const bool machine_frame = block.non_modal == 53;
    const Axes& system = coordinates_.at(block.modal.coordinates);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        block.axes[axis] *= unit;
        block.offsets[axis] *= unit;
        block.target_mm[axis] = position_mm_[axis];
        if (!block.axis_given[axis]) {
            continue;
        }
        const double tool = axis == 2 ? tool_length_mm_ : 0.0;
        if (machine_frame) {
            block.target_mm[axis] = block.axes[axis];
        } else if (block.modal.relative) {
            block.target_mm[axis] = position_mm_[axis] + block.axes[axis];
        } else {
            block.target_mm[axis] = block.axes[axis] + system[axis] + g92_mm_[axis] + tool;
        }
    }
    if (block.r) {
        block.r = *block.r * unit;
    }
}

void GcodeInterpreter::execute(Block& block, const Rules& rules, std::vector<Action>& actions) {
    if (block.modal.coordinates != modal_.coordinates) {
        actions.push_back({.kind = Action::Kind::Offset, .move = {}});
    }
    execute_beam(block, rules, actions);
    if (block.modal.flood != modal_.flood) {
        actions.push_back({.kind = Action::Kind::Sync, .move = {}});
    }
    modal_ = block.modal;
    if (block.non_modal == 4) {
        actions.push_back({.kind = Action::Kind::Dwell, .move = {}, .seconds = *block.p});
    }
    if (block.tool_offset) {
        tool_length_mm_ = *block.tool_offset == 43 ? block.axes[2] : 0.0;
        actions.push_back({.kind = Action::Kind::Offset, .move = {}});
    }
    execute_axes(block, rules, actions);
    if (block.stop == 0) {
        actions.push_back({.kind = Action::Kind::Pause, .move = {}});
    } else if (block.stop == 2 || block.stop == 30) {
        // NIST RS274/NGC section 3.6.1 as Grbl does it: these modes go back to their defaults.
        modal_.motion = Motion::Linear;
        modal_.plane = 17;
        modal_.relative = false;
        modal_.inverse_time = false;
        modal_.coordinates = 54;
        modal_.beam = BeamMode::Off;
        modal_.flood = false;
        actions.push_back({.kind = Action::Kind::Beam, .move = {}});
        actions.push_back({.kind = Action::Kind::End, .move = {}});
    }
}

// When S or M3/M4/M5 must stop the machine, and what burns while it stands. In laser mode a line
// that moves carries its S along instead.
void GcodeInterpreter::execute_beam(const Block& block,
                                    const Rules& rules,
                                    std::vector<Action>& actions) const {
    const bool dark = rules.laser_mode && !is_burning_motion(block.modal.motion);
    const bool in_motion = rules.laser_mode && block.moves();
    const bool was_burning = is_burning_motion(modal_.motion);
    const bool forced = rules.laser_mode && !block.moves() && modal_.beam == BeamMode::Constant &&
                        was_burning == dark;
    const auto stand = [&](BeamMode beam) {
        Action action{.kind = Action::Kind::Beam, .move = {}};
        action.move.beam = beam;
        const bool lit =
            !dark && beam != BeamMode::Off && !(rules.laser_mode && beam == BeamMode::Dynamic);
        action.move.power_s = lit ? block.modal.power_s : 0.0;
        actions.push_back(action);
    };
    if ((block.modal.power_s != modal_.power_s || forced) && modal_.beam != BeamMode::Off &&
        !in_motion) {
        stand(modal_.beam);
    }
    if (block.modal.beam != modal_.beam) {
        stand(block.modal.beam);
    }
}

void GcodeInterpreter::execute_axes(Block& block,
                                    const Rules& rules,
                                    std::vector<Action>& actions) {
    const int code = block.non_modal.value_or(0);
    if (code == 28 || code == 30) {
        Block rapid = block;
        rapid.modal.motion = Motion::Rapid;
        if (block.any_axis()) {
            add_line(rapid, rules, block.target_mm, actions);
        }
        Axes home = code == 28 ? g28_mm_ : g30_mm_;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const bool stays = block.any_axis() && !block.axis_given[axis];
            home[axis] = stays ? position_mm_[axis] : home[axis];
        }
        add_line(rapid, rules, home, actions);
        return;
    }
    if (code == 281) {
        g28_mm_ = position_mm_;
    } else if (code == 301) {
        g30_mm_ = position_mm_;
    } else if (code == 10 || code == 92 || code == 921) {
        set_offsets(block);
        actions.push_back({.kind = Action::Kind::Offset, .move = {}});
    }
    if (block.moves()) {
        const bool arc =
            block.modal.motion == Motion::ArcCw || block.modal.motion == Motion::ArcCcw;
        arc ? add_arc(block, rules, actions) : add_line(block, rules, block.target_mm, actions);
    }
}

// G10 L2 and L20, G92, G92.1.
void GcodeInterpreter::set_offsets(const Block& block) {
    if (block.non_modal == 921) {
        g92_mm_ = Axes{};
        return;
    }
    const bool stored = block.non_modal == 10;
    const bool from_here = !stored || std::trunc(*block.l) == 20.0;
    const int chosen = whole_part(block.p.value_or(0.0));
    const int system = stored && chosen != 0 ? 53 + chosen : modal_.coordinates;
    Axes& offset = stored ? coordinates_.at(system) : g92_mm_;
    const Axes& other = stored ? g92_mm_ : coordinates_.at(modal_.coordinates);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (block.axis_given[axis]) {
            const double tool = axis == 2 ? tool_length_mm_ : 0.0;
            offset[axis] = from_here ? position_mm_[axis] - other[axis] - tool - block.axes[axis]
                                     : block.axes[axis];
        }
    }
}

void GcodeInterpreter::add_line(const Block& block,
                                const Rules& rules,
                                const Axes& target,
                                std::vector<Action>& actions) {
    Action action{.kind = Action::Kind::Move, .move = {}};
    Move& move = action.move;
    double mm_squared = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        move.target_mm[axis] = to_steps(target[axis], rules.steps_per_mm[axis]);
        mm_squared += (target[axis] - position_mm_[axis]) * (target[axis] - position_mm_[axis]);
    }
    move.rapid = block.modal.motion == Motion::Rapid;
    // Inverse time: F is moves per minute.
    move.feed_mm_per_min = block.modal.inverse_time
                               ? block.modal.feed_mm_per_min * std::sqrt(mm_squared)
                               : block.modal.feed_mm_per_min;
    move.beam = block.modal.beam;
    const bool dark = rules.laser_mode && move.rapid;
    move.power_s = dark ? 0.0 : block.modal.power_s;
    move.scale_power = rules.laser_mode && move.beam == BeamMode::Dynamic;
    move.work_offset_mm = work_offset_mm();
    position_mm_ = target;
    actions.push_back(action);
}

std::string GcodeInterpreter::report_modal(bool inches) const {
    const int motion = static_cast<int>(modal_.motion);
    const int beam = modal_.beam == BeamMode::Off ? 5 : (modal_.beam == BeamMode::Constant ? 3 : 4);
    return fmt::format(
        "[GC:G{} G{} G{} G{} G{} G{} M{} M{} T{} F{:.{}f} S{:.0f}]", motion, modal_.coordinates,
        modal_.plane, modal_.inches ? 20 : 21, modal_.relative ? 91 : 90,
        modal_.inverse_time ? 93 : 94, beam, modal_.flood ? 8 : 9, modal_.tool,
        modal_.feed_mm_per_min / (inches ? kMmPerInch : 1.0), inches ? 1 : 0, modal_.power_s);
}

std::string GcodeInterpreter::report_offsets(bool inches) const {
    const int digits = inches ? 4 : 3;
    const double unit = inches ? kMmPerInch : 1.0;
    const auto triple = [&](const Axes& mm) {
        return fmt::format("{:.{}f},{:.{}f},{:.{}f}", mm[0] / unit, digits, mm[1] / unit, digits,
                           mm[2] / unit, digits);
    };
    std::string text;
    for (const auto& [number, offset] : coordinates_) {
        text += fmt::format("[G{}:{}]\r\n", number, triple(offset));
    }
    text += fmt::format("[G28:{}]\r\n[G30:{}]\r\n[G92:{}]\r\n[TLO:{:.{}f}]\r\n[PRB:{}:0]\r\n",
                        triple(g28_mm_), triple(g30_mm_), triple(g92_mm_), tool_length_mm_ / unit,
                        digits, triple(Axes{}));
    return text;
}

}  // namespace leafcutter::drivers
