// Grbl's answer to '?': <State[:sub]|MPos:x,y,z or
// WPos:x,y,z|Bf:15,128|FS:feed,s|WCO:x,y,z|Ov:f,r,s|…> Fields after the state are optional and come
// in any order; unknown ones are skipped.

#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "drivers/device.h"

namespace leafcutter::drivers {

struct StatusReport {
    MachineState state = MachineState::Unknown;
    std::optional<int> sub_state;                           // Hold:0 stands, Hold:1 slows down.
    std::optional<std::array<double, 3>> machine_position;  // In the unit of $13.
    std::optional<std::array<double, 3>> work_position;
    std::optional<std::array<double, 3>> work_offset;
    std::optional<std::array<int, 2>> free_buffers;  // Planner blocks, receive bytes.
    std::optional<double> feed;
    std::optional<double> power_s;
    std::optional<std::array<int, 3>> override_percent;
};

// Nothing for a line that is no status report, or one with a broken number.
std::optional<StatusReport> parse_status_report(std::string_view line);

}  // namespace leafcutter::drivers
