// Colours of materials as numbers.

#pragma once

#include <array>
#include <string_view>

namespace leafcutter::fab {

// Red, green, blue from 0 to 1, as screens have them (sRGB).
using Rgb = std::array<double, 3>;

// "#rrggbb"; grey for anything else.
Rgb rgb_of(std::string_view colour);

// As light adds up: what shaders work in.
Rgb linear_of(const Rgb& srgb);

}  // namespace leafcutter::fab
