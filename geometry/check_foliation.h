// Checks a finished foliation against its surface. A wrong answer that looks right is the worst
// there is.

#pragma once

#include "geometry/foliation.h"
#include "geometry/surface_part.h"

namespace leafcutter::geometry {

// The area of the charts is that of the surface, their number and the prongs of singular points are
// those that its Euler characteristic asks for, and every chart is finite, without flips, and fills
// its rectangle. `foliation` is that of `part`, whose holes are open.
// Throws Error(SelfCheck, "foliation-check") naming what is wrong.
void check_foliation(const Foliation& foliation, const SurfacePart& part);

}  // namespace leafcutter::geometry
