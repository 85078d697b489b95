// Widths of strips in messages.

#pragma once

#include <cmath>

namespace leafcutter::geometry {

// To four digits, downwards: where wider strips won't do, so wide ones still do.
inline double rounded_down(double width) {
    const double digit = std::pow(10.0, std::floor(std::log10(width)) - 3.0);
    return std::floor(width / digit) * digit;
}

}  // namespace leafcutter::geometry
