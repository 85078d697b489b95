#include "fab/export/colour.h"

#include <charconv>
#include <cmath>

namespace leafcutter::fab {

Rgb rgb_of(std::string_view colour) {
    constexpr Rgb kGrey{0.5, 0.5, 0.5};
    if (colour.size() != 7 || colour.front() != '#') {
        return kGrey;
    }
    Rgb result{};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string_view digits = colour.substr(1 + 2 * i, 2);
        unsigned value = 0;
        const auto read = std::from_chars(digits.data(), digits.data() + 2, value, 16);
        if (read.ptr != digits.data() + 2) {
            return kGrey;
        }
        result[i] = value / 255.0;
    }
    return result;
}

Rgb linear_of(const Rgb& srgb) {
    // IEC 61966-2-1.
    Rgb result{};
    for (std::size_t i = 0; i < 3; ++i) {
        result[i] = srgb[i] <= 0.04045 ? srgb[i] / 12.92 : std::pow((srgb[i] + 0.055) / 1.055, 2.4);
    }
    return result;
}

}  // namespace leafcutter::fab
