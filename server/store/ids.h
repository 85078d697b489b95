// Names of things: sortable by time, never guessable, and the wall clock that stamps them.

#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace leafcutter::server {

std::int64_t wall_clock_ms();

// "2026-01-31T12:00:00.000Z", RFC 3339.
std::string rfc3339(std::int64_t wall_ms);

// `prefix`, then 48 bits of time and 80 of the kernel's randomness in base 32: "j_01J…".
std::string new_id(std::string_view prefix);

}  // namespace leafcutter::server
