// Numbers as files of ours spell them.

#pragma once

#include <string>

#include <fmt/format.h>

namespace leafcutter::fab {

// At most three decimals, none that say nothing, no negative zero.
inline std::string short_number(double value) {
    std::string text = fmt::format("{:.3f}", value);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') {
        text.pop_back();
    }
    return text == "-0" ? "0" : text;
}

}  // namespace leafcutter::fab
