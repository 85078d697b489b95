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

std::string triple(const Axes& mm) {
    return fmt::format("{:.3f},{:.3f},{:.3f}", mm[0], mm[1], mm[2]);
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
        execute(block, rules, result.actions);
    }
    return result;
}

Interpretation GcodeInterpreter::run_jog(std::string_view stripped, const Rules& rules) {
    Interpretation result;
    Block block;
    result.error = read_words(stripped, block);
    if (result.error != 0) {
        return result;
    }
    const bool others = block.motion_word || block.stop || block.beam_word || block.tool_offset ||
                        block.s || block.t || block.p || block.l || block.r ||
                        block.modal.plane != modal_.plane || block.modal.flood != modal_.flood ||
                        block.modal.coordinates != modal_.coordinates || block.modal.inverse_time ||
                        (block.non_modal && *block.non_modal != 53);
    if (others) {
        result.error = grbl_error::kBadJog;
    } else if (!block.feed || *block.feed == 0.0) {
        result.error = grbl_error::kUndefinedFeed;
    } else if (!block.any_axis()) {
        result.error = grbl_error::kNoAxisWords;
    }
    if (result.error != 0) {
        return result;
    }
    block.jog = true;
    block.modal.motion = Motion::Linear;
    const double unit = block.modal.inches ? kMmPerInch : 1.0;
    block.modal.feed_mm_per_min = *block.feed * unit;
    resolve_target(block);
    add_line(block, rules, block.target_mm, result.actions);
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
    if (block.line_number && *block.line_number > 9999999.0) {
        return grbl_error::kLineNumber;
    }
    if (block.t && *block.t > 255.0) {
        return grbl_error::kToolNumber;
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
    } else if (modal_.inverse_time) {
        block.modal.feed_mm_per_min = 0.0;
    }
    block.modal.power_s = block.s.value_or(modal_.power_s);
    block.modal.tool = static_cast<int>(block.t.value_or(modal_.tool));
    if (block.tool_offset == 431 &&
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
        if (!block.p || !block.l) {
            return grbl_error::kValueMissing;
        }
        if (*block.p > 6.0) {
            return grbl_error::kCoordinateSystem;
        }
        if ((*block.l != 2.0 && *block.l != 20.0) || block.r) {
            return grbl_error::kUnsupported;
        }
    }
    if (code == 92 && !block.any_axis()) {
        return grbl_error::kNoAxisWords;
    }
    if (code == 53 && block.modal.motion != Motion::Rapid && block.modal.motion != Motion::Linear) {
        return grbl_error::kG53Motion;
    }
    if ((block.p && code != 4 && code != 10) || (block.l && code != 10)) {
        return grbl_error::kUnusedWords;
    }
    return 0;
}

int GcodeInterpreter::check_motion(Block& block, bool motion_line) const {
    const bool offsets = block.offset_given[0] || block.offset_given[1] || block.offset_given[2];
    const bool other_axes_user = block.non_modal && *block.non_modal != 53 && *block.non_modal != 4;
    if (block.modal.motion == Motion::None && block.any_axis() && !other_axes_user &&
        !block.tool_offset) {
        return grbl_error::kAxisWordsExist;
    }
    if (motion_line && block.modal.motion != Motion::Rapid && block.modal.feed_mm_per_min == 0.0) {
        return grbl_error::kUndefinedFeed;
    }
    const bool arc = block.modal.motion == Motion::ArcCw || block.modal.motion == Motion::ArcCcw;
    if (motion_line && arc) {
        return check_arc(block);
    }
    return offsets || block.r ? grbl_error::kUnusedWords : 0;
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
    modal_ = block.modal;
    if (block.non_modal == 4) {
        actions.push_back({.kind = Action::Kind::Dwell, .move = {}, .seconds = *block.p});
    }
    if (block.tool_offset) {
        tool_length_mm_ = *block.tool_offset == 431 ? block.axes[2] : 0.0;
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
        add_line(rapid, rules, code == 28 ? g28_mm_ : g30_mm_, actions);
    } else if (code == 281) {
        g28_mm_ = position_mm_;
    } else if (code == 301) {
        g30_mm_ = position_mm_;
    } else if (code == 10 || code == 92 || code == 921) {
        set_offsets(block);
        actions.push_back({.kind = Action::Kind::Offset, .move = {}});
    } else if (block.moves()) {
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
    const bool from_here = !stored || *block.l == 20.0;
    const int system =
        stored && *block.p != 0.0 ? 53 + static_cast<int>(*block.p) : modal_.coordinates;
    Axes& offset = stored ? coordinates_.at(system) : g92_mm_;
    const Axes& other = stored ? g92_mm_ : coordinates_.at(modal_.coordinates);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (block.axis_given[axis]) {
            offset[axis] =
                from_here ? position_mm_[axis] - other[axis] - block.axes[axis] : block.axes[axis];
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

std::string GcodeInterpreter::report_modal() const {
    const int motion = static_cast<int>(modal_.motion);
    const int beam = modal_.beam == BeamMode::Off ? 5 : (modal_.beam == BeamMode::Constant ? 3 : 4);
    return fmt::format("[GC:G{} G{} G{} G{} G{} G{} M{} M{} T{} F{:.0f} S{:.0f}]", motion,
                       modal_.coordinates, modal_.plane, modal_.inches ? 20 : 21,
                       modal_.relative ? 91 : 90, modal_.inverse_time ? 93 : 94, beam,
                       modal_.flood ? 8 : 9, modal_.tool, modal_.feed_mm_per_min, modal_.power_s);
}

std::string GcodeInterpreter::report_offsets() const {
    std::string text;
    for (const auto& [number, offset] : coordinates_) {
        text += fmt::format("[G{}:{}]\r\n", number, triple(offset));
    }
    text += fmt::format("[G28:{}]\r\n[G30:{}]\r\n[G92:{}]\r\n[TLO:{:.3f}]\r\n[PRB:{}:0]\r\n",
                        triple(g28_mm_), triple(g30_mm_), triple(g92_mm_), tool_length_mm_,
                        triple(Axes{}));
    return text;
}

}  // namespace leafcutter::drivers
