// One line of G-code, its words sorted into what they ask for. Private to the interpreter.

#pragma once

#include <array>
#include <optional>

#include "drivers/sim/gcode_interpreter.h"

namespace leafcutter::drivers {

namespace grbl_error {
constexpr int kLetterExpected = 1;
constexpr int kBadNumber = 2;
constexpr int kNegative = 4;
constexpr int kUnsupported = 20;
constexpr int kModalGroup = 21;
constexpr int kUndefinedFeed = 22;
constexpr int kNotInteger = 23;
constexpr int kAxisConflict = 24;
constexpr int kWordRepeated = 25;
constexpr int kNoAxisWords = 26;
constexpr int kLineNumber = 27;
constexpr int kValueMissing = 28;
constexpr int kCoordinateSystem = 29;
constexpr int kG53Motion = 30;
constexpr int kAxisWordsExist = 31;
constexpr int kNoAxisWordsInPlane = 32;
constexpr int kBadTarget = 33;
constexpr int kArcRadius = 34;
constexpr int kNoOffsetsInPlane = 35;
constexpr int kUnusedWords = 36;
constexpr int kToolOffsetAxis = 37;
constexpr int kToolNumber = 38;
constexpr int kBadJog = 16;
}  // namespace grbl_error

struct GcodeInterpreter::Block {
    Modal modal;  // As it is after this line.
    std::optional<Motion> motion_word;
    std::optional<int> non_modal;    // 4, 10, 28, 30, 53, 92; G28.1 is 281, and so on.
    std::optional<int> tool_offset;  // 431, 49
    std::optional<int> stop;         // M0 1 2 30
    std::optional<BeamMode> beam_word;
    std::array<bool, 3> axis_given{};
    Axes axes{};  // As written, then in mm.
    std::array<bool, 3> offset_given{};
    Axes offsets{};  // I J K
    std::optional<double> feed;
    std::optional<double> line_number;
    std::optional<double> l;
    std::optional<double> p;
    std::optional<double> r;
    std::optional<double> s;
    std::optional<double> t;
    Axes target_mm{};
    bool jog = false;
    bool not_for_jog = false;  // Holds a command that $J= doesn't take.

    bool any_axis() const { return axis_given[0] || axis_given[1] || axis_given[2]; }
    // G10, G28, G30, G92, G43.1 and G49 take the axis words themselves.
    bool other_axes_user() const {
        const int code = non_modal.value_or(0);
        return tool_offset || code == 10 || code == 28 || code == 30 || code == 92;
    }
    // The axis words belong to a motion.
    bool moves() const { return any_axis() && modal.motion != Motion::None && !other_axes_user(); }
};

}  // namespace leafcutter::drivers
