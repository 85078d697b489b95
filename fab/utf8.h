// File names come in any bytes; what we write is UTF-8.

#pragma once

#include <string>
#include <string_view>

namespace leafcutter::fab {

// `text` with every byte that belongs to no valid UTF-8 sequence replaced by U+FFFD.
std::string valid_utf8(std::string_view text);

}  // namespace leafcutter::fab
