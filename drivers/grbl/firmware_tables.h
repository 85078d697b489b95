// What Grbl 1.1's alarm and error numbers mean. Other firmware has tables of its own: never share
// these.

#pragma once

#include <string>

namespace leafcutter::drivers {

// "ALARM:1, hard limit: the position is lost, home the machine"; an unknown code as it is.
std::string alarm_text(int code);
std::string error_text_of_grbl(int code);

}  // namespace leafcutter::drivers
