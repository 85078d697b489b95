// Places where a test kills the daemon: before and after every step that has to survive it.

#pragma once

#include <string_view>

namespace leafcutter::server {

// Ends the process at once, as kill -9 would, if the environment's LEAFCUTTER_CRASH says
// "name:N" and this is the N-th time that it comes here; otherwise costs one comparison.
void crash_point(std::string_view name);

}  // namespace leafcutter::server
