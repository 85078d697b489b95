// What the numbers of alarms, errors and settings mean. The firmwares of the family share the low
// ones and differ in the rest: each has its table.

#pragma once

#include <string>
#include <string_view>

#include "drivers/grbl/firmware.h"

namespace leafcutter::drivers {

// "ALARM:1, hard limit: the position is lost, home the machine"; an unknown code as it is.
std::string alarm_text(GrblFirmware firmware, int code);
std::string error_text(GrblFirmware firmware, int code);

// "laser mode", for $32; empty for a number that isn't known.
std::string_view setting_name(GrblFirmware firmware, int number);

}  // namespace leafcutter::drivers
