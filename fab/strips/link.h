// Which pieces are joined to which, and the slits that their arrows go through.

#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "fab/strips/strip.h"
#include "fab/strips/strips.h"

namespace leafcutter::fab {

// Tells every tab what it is joined to: the next piece of its strip, of a closed one the first
// after the last, or the first piece of the next strip, across a critical leaf. Cuts a slit there
// for each arrow. `limits` are those of weft and warp.
void link_pieces(std::span<const Strip> strips,
                 const std::array<PieceLimits, 2>& limits,
                 std::span<Piece> pieces,
                 std::vector<std::string>& warnings);

}  // namespace leafcutter::fab
