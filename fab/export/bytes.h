// Numbers as the bytes of binary files: little end first, whatever this machine does.

#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <string>

namespace leafcutter::fab {

template <std::unsigned_integral Number>
void append_bytes(std::string& out, Number value) {
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
        out.push_back(static_cast<char>((value >> (8 * i)) & 0xff));
    }
}

inline void append_bytes(std::string& out, float value) {
    append_bytes(out, std::bit_cast<std::uint32_t>(value));
}

}  // namespace leafcutter::fab
