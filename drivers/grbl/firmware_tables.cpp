#include "drivers/grbl/firmware_tables.h"

#include <array>
#include <string_view>

#include <fmt/format.h>

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

struct CodeText {
    int code;
    std::string_view text;
};

// grblHAL, alarms.h: where it goes another way than Grbl.
constexpr std::array<CodeText, 13> kHalAlarms{{
    {10, "emergency stop pressed: release it, then reset"},
    {11, "homing needed: home the machine"},
    {12, "a limit switch is closed: free it"},
    {13, "probe protection tripped"},
    {14, "spindle not at speed in time"},
    {15, "homing: the second switch of a squared axis not found"},
    {16, "power-on self-test failed"},
    {17, "motor fault"},
    {18, "homing is badly configured"},
    {19, "Modbus failure"},
    {20, "I/O expander failure"},
    {21, "settings memory failed"},
    {22, "buffer overflow"},
}};

// FluidNC, Alarm.h.
constexpr std::array<CodeText, 9> kFluidAlarms{{
    {10, "spindle control failed"},
    {11, "an input was active at start-up"},
    {12, "a limit switch is closed and it is not known which: free it"},
    {13, "hard stop"},
    {14, "not homed: home the machine"},
    {15, "start-up failed"},
    {16, "I/O expander reset"},
    {17, "error in the G-code"},
    {18, "probe: a limit switch closed"},
}};

// grblHAL, errors.h.
constexpr std::array<CodeText, 34> kHalErrors{{
    {18, "reset asserted"},
    {19, "the value must be above 0"},
    {38, "no such tool"},
    {39, "value out of range"},
    {40, "tool change under way"},
    {41, "spindle not running"},
    {42, "wrong plane for this command"},
    {43, "feed rate above the maximum"},
    {44, "S out of range"},
    {45, "a limit switch is closed"},
    {46, "home the machine first"},
    {47, "wrong tool"},
    {48, "two words contradict each other"},
    {49, "self-test failed"},
    {50, "emergency stop pressed"},
    {51, "motor fault"},
    {52, "setting out of range"},
    {53, "setting switched off"},
    {54, "wrong retract position"},
    {55, "homing is badly configured"},
    {56, "coordinate system locked"},
    {57, "file demarcation not expected"},
    {58, "no such port"},
    {60, "card not mounted"},
    {61, "file can't be read"},
    {62, "folder can't be opened"},
    {63, "no such folder"},
    {64, "card not mounted"},
    {65, "no file system"},
    {66, "file system is read-only"},
    {70, "Bluetooth failed"},
    {77, "log in first"},
    {78, "access denied"},
    {79, "not during a critical event"},
}};

// FluidNC, Error.h.
constexpr std::array<CodeText, 26> kFluidErrors{{
    {18, "no homing cycle is configured"},
    {19, "this axis can't be homed alone"},
    {39, "P too large"},
    {40, "a control input is active"},
    {60, "file system not mounted"},
    {61, "file can't be read"},
    {62, "folder can't be opened"},
    {63, "no such folder"},
    {64, "file is empty"},
    {65, "no such file"},
    {66, "file can't be opened"},
    {67, "file system busy"},
    {68, "folder can't be deleted"},
    {69, "file can't be deleted"},
    {70, "file can't be renamed"},
    {80, "setting out of range"},
    {81, "setting has a wrong value"},
    {90, "message can't be sent"},
    {100, "setting can't be stored"},
    {110, "log in first"},
    {113, "reset"},
    {120, "another interface is in use"},
    {130, "jog cancelled"},
    {150, "wrong pin in the configuration"},
    {151, "wrong setting in the configuration"},
    {152, "the configuration is wrong"},
}};

// grbl 1.1h, doc/csv/setting_codes_en_US.csv; the others keep these numbers.
constexpr std::array<CodeText, 34> kSettings{{
    {0, "step pulse, us"},
    {1, "step idle delay, ms (255: motors stay on)"},
    {2, "step invert, mask"},
    {3, "direction invert, mask"},
    {4, "step enable invert"},
    {5, "limit pins invert"},
    {6, "probe pin invert"},
    {10, "status report, mask"},
    {11, "junction deviation, mm"},
    {12, "arc tolerance, mm"},
    {13, "report in inches"},
    {20, "soft limits"},
    {21, "hard limits"},
    {22, "homing"},
    {23, "homing direction invert, mask"},
    {24, "homing feed, mm/min"},
    {25, "homing seek, mm/min"},
    {26, "homing debounce, ms"},
    {27, "homing pull-off, mm"},
    {30, "S of full power"},
    {31, "S of least power"},
    {32, "laser mode"},
    {100, "X steps/mm"},
    {101, "Y steps/mm"},
    {102, "Z steps/mm"},
    {110, "X maximum rate, mm/min"},
    {111, "Y maximum rate, mm/min"},
    {112, "Z maximum rate, mm/min"},
    {120, "X acceleration, mm/s2"},
    {121, "Y acceleration, mm/s2"},
    {122, "Z acceleration, mm/s2"},
    {130, "X travel, mm"},
    {131, "Y travel, mm"},
    {132, "Z travel, mm"},
}};

template <std::size_t Count>
std::string_view find(const std::array<CodeText, Count>& table, int code) {
    for (const CodeText& entry : table) {
        if (entry.code == code) {
            return entry.text;
        }
    }
    return {};
}

template <std::size_t Count>
std::string_view find(const std::array<std::string_view, Count>& table, int code) {
    return code > 0 && static_cast<std::size_t>(code) < Count
               ? table[static_cast<std::size_t>(code)]
               : std::string_view{};
}

// Up to these codes all of them mean the same.
constexpr int kCommonAlarms = 9;
constexpr int kCommonErrors = 37;

std::string_view alarm_of(GrblFirmware firmware, int code) {
    switch (firmware) {
        case GrblFirmware::Grbl:
            return find(kAlarms, code);
        case GrblFirmware::GrblHal:
            return code <= kCommonAlarms ? find(kAlarms, code) : find(kHalAlarms, code);
        case GrblFirmware::FluidNc:
            return code <= kCommonAlarms ? find(kAlarms, code) : find(kFluidAlarms, code);
        case GrblFirmware::Other:
            break;
    }
    return code <= kCommonAlarms ? find(kAlarms, code) : std::string_view{};
}

std::string_view error_of(GrblFirmware firmware, int code) {
    const std::string_view own = firmware == GrblFirmware::GrblHal   ? find(kHalErrors, code)
                                 : firmware == GrblFirmware::FluidNc ? find(kFluidErrors, code)
                                                                     : std::string_view{};
    const bool common = firmware == GrblFirmware::Grbl || code <= kCommonErrors ||
                        (firmware == GrblFirmware::FluidNc && code == kCommonErrors + 1);
    return own.empty() && common ? find(kErrors, code) : own;
}

std::string described(std::string_view prefix, int code, std::string_view text) {
    return text.empty() ? fmt::format("{}{}", prefix, code)
                        : fmt::format("{}{}, {}", prefix, code, text);
}

}  // namespace

std::string alarm_text(GrblFirmware firmware, int code) {
    return described("ALARM:", code, alarm_of(firmware, code));
}

std::string error_text(GrblFirmware firmware, int code) {
    return described("error:", code, error_of(firmware, code));
}

std::string_view setting_name(GrblFirmware firmware, int number) {
    // FluidNC keeps its configuration in a file and shows some numbers for the sake of senders.
    return firmware == GrblFirmware::Other ? std::string_view{} : find(kSettings, number);
}

}  // namespace leafcutter::drivers
