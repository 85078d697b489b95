// A line with a number and a checksum as Marlin and Smoothieware read it: "N12 G1 X3*97".

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace leafcutter::drivers {

struct NumberedLine {
    std::optional<std::size_t> number;  // None: the line doesn't begin with N.
    bool has_sum = false;
    bool sum_holds = false;
    bool sets_number = false;  // M110.
    std::string text;          // Without number and sum.
};

NumberedLine read_numbered_line(std::string_view line);

}  // namespace leafcutter::drivers
