#include "drivers/grbl/firmware_tables.h"

#include <array>
#include <string_view>

namespace leafcutter::drivers {

namespace {

// grbl 1.1h, doc/csv/alarm_codes_en_US.csv; the index is the code.
constexpr std::array<std::string_view, 11> kAlarms{
    "",
    "hard limit: the position is lost, reset and home the machine",
    "soft limit: the target lies beyond the travel; the position is kept, reset and unlock",
    "reset while moving: the position is lost, home the machine",
    "probe: not in its initial state",
    "probe: no contact within the travel",
    "homing: reset during the cycle",
    "homing: door opened during the cycle",
    "homing: the limit switch stays closed after pulling off",
    "homing: no limit switch found within the travel",
    "homing: the second switch of a dual axis not found",
};

// grbl 1.1h, doc/csv/error_codes_en_US.csv; the index is the code.
constexpr std::array<std::string_view, 39> kErrors{
    "",
    "a word doesn't begin with a letter",
    "a number is missing or wrong",
    "unknown $ command",
    "a negative value where none is allowed",
    "homing is off ($22)",
    "step pulse below 3 us",
    "EEPROM read failed, defaults restored",
    "$ command needs the machine idle",
    "locked by an alarm or a jog",
    "soft limits need homing ($22)",
    "line too long",
    "step rate too high",
    "door open",
    "startup line or build info too long",
    "jog target beyond the travel",
    "invalid jog command",
    "laser mode needs a PWM output",
    "",
    "",
    "unsupported command",
    "two commands of one modal group",
    "no feed rate set",
    "an integer is needed",
    "two commands use the axis words",
    "a word is repeated",
    "axis words missing",
    "line number out of range",
    "a value word is missing (P or L)",
    "G59.x is not supported",
    "G53 needs G0 or G1",
    "axis words without a command that uses them",
    "arc: no axis words in the plane",
    "arc: target can't be reached",
    "arc: radius too small",
    "arc: offsets missing in the plane",
    "unused words",
    "G43.1 only for the tool axis",
    "tool number too large",
};

template <std::size_t Count>
std::string describe(std::string_view prefix,
                     const std::array<std::string_view, Count>& table,
                     int code) {
    std::string text = std::string(prefix) + std::to_string(code);
    if (code > 0 && static_cast<std::size_t>(code) < Count &&
        !table[static_cast<std::size_t>(code)].empty()) {
        text += ", " + std::string(table[static_cast<std::size_t>(code)]);
    }
    return text;
}

}  // namespace

std::string alarm_text(int code) {
    return describe("ALARM:", kAlarms, code);
}

std::string error_text_of_grbl(int code) {
    return describe("error:", kErrors, code);
}

}  // namespace leafcutter::drivers
