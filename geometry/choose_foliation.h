// Chooses how to foliate a connected surface: in which mode and with which holes.

#pragma once

#include "geometry/foliation.h"
#include "geometry/surface_part.h"

namespace leafcutter::geometry {

// Cells of a conformal foliation grow and shrink exponentially along limbs. So the natural mode of
// the surface is compared with what holes at the tips of its limbs give, unless the options say
// what is wanted. `alternatives` has what was compared.
// Throws as compute_foliation does.
Foliation choose_foliation(const SurfacePart& part,
                           const FoliationOptions& options,
                           const Context& context);

}  // namespace leafcutter::geometry
