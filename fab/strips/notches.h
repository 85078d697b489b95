// Notches that a beam can't cut.

#pragma once

#include "fab/strips/strip.h"

namespace leafcutter::fab {

// `outline` with every notch filled that is narrower than `width_mm` (the kerf) and larger than a
// hundredth of a square millimetre: the beam, half a kerf outside, would leave it filled anyway.
// Everything else keeps its points exactly.
Ring without_notches(const Ring& outline, double width_mm);

}  // namespace leafcutter::fab
