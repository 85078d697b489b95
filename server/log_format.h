// How the daemon's log lines look, on standard error.

#pragma once

namespace leafcutter::server {

enum class LogFormat { Text, Json };

// Replaces the default logger. Json: one object a line, with time, level and message. A reader that
// falls behind costs it lines, never a writer its time.
void begin_log(LogFormat format);

}  // namespace leafcutter::server
