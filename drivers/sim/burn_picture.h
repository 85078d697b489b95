// A picture of what a beam burnt: a layer for each power, the travel between as thin lines.

#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "drivers/sim/beam_log.h"

namespace leafcutter::drivers {

// In true size, Y up. Layers are named for Inkscape by their S word.
std::string burn_svg(std::span<const BurntPiece> pieces);

// The bytes of a PNG file whose longer side has so many pixels. Throws std::invalid_argument for
// less than 16 of them, or more than 16384.
std::string burn_png(std::span<const BurntPiece> pieces, std::size_t pixels = 2000);

}  // namespace leafcutter::drivers
