// Foliates a connected surface in a given mode. Internal to the choice of a foliation.

#pragma once

#include "geometry/foliation.h"
#include "geometry/surface_part.h"

namespace leafcutter::geometry {

// `options` name vertices and loops of the surface the user gave; those of other parts are left
// aside. The result is checked, and its vertices are again those of the surface the user gave.
// Throws Error(BadOption, "mode-does-not-fit") if the part's topology isn't that of the mode, and
// Error(BadOption) for names of what is not on the part, as the single cases do.
Foliation foliate_part(const SurfacePart& part,
                       FoliationMode mode,
                       const FoliationOptions& options,
                       const Context& context);

// How many more holes the part needs before it can be foliated in this mode; -1 if holes don't
// help.
int holes_needed(const SurfacePart& part, FoliationMode mode);

}  // namespace leafcutter::geometry
