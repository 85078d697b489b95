// The joints between pieces: which end is joined to which start, and how far its tab reaches.

#pragma once

#include <span>
#include <vector>

#include "fab/strips/strip.h"

namespace leafcutter::fab {

struct StripJoint {
    int piece = 0;  // Its end is joined, into the list of pieces,
    int onto = 0;   // to the start of this one.
    int strip = 0;  // The strip of the first.
    int onto_strip = 0;
    int before = -1;  // The strip's cell behind the joint; -1 where another strip begins there.
};

// Per strip the numbers of its pieces in walking order.
std::vector<std::vector<int>> pieces_of_strips(std::span<const Strip> strips,
                                               std::span<const Piece> pieces);

// One for each two pieces that follow each other on a strip, for the ends of closed strips, and for
// strips that go on into the next one. In the order of strips and pieces.
std::vector<StripJoint> joints_of(std::span<const Strip> strips, std::span<const Piece> pieces);

// Cells at the start of the second piece that the joint's tab lies on; 0 without a tab.
int cells_under_tab(const StripJoint& joint, std::span<const Piece> pieces);

}  // namespace leafcutter::fab
