// Joined cylinders with columns of even width on the surface.
//
// Columns that are even in g are narrow on the inside of a bend and wide on its outside. They may
// as well be spaced by their mean width on the surface, cylinder by cylinder: leaves stay leaves.
// Where neighbouring cylinders want different widths for one column it has to slant a little.

#pragma once

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/quads/conforming_mesh.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

// As join_cylinders: of columns even in g, even on the surface, and between, those that make the
// areas of cells vary least while mean angles are at most 3 % worse.
JoinedMesh join_evenly(const Foliation& foliation,
                       const GridOptions& options,
                       const Context& context);

}  // namespace leafcutter::geometry
