// Joins parts of no width to their neighbours.
//
// On symmetric surfaces a leaf from one zero runs into another zero. A mesh is never quite
// symmetric: the leaf passes by, and between it and the other zero's leaf lies a part of no width.

#pragma once

#include "geometry/harmonic/leaf_cut.h"

namespace leafcutter::geometry {

// Removes parts that carry less than `share` of the flux and of the area: the zeros on their two
// flanks are joined by paths through them, and what lies on either side of those goes to the
// neighbours there. Parts along natural loops stay. Returns the number of parts removed. Throws as
// separate_parts does.
int join_thin_parts(CutSurface& cut, double share, const Context& context);

}  // namespace leafcutter::geometry
