// Tabs where cylinders meet without sharing vertices (geometry::Junctions::Independent).

#pragma once

#include <span>

#include "fab/strips/strip.h"
#include "geometry/foliation.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

// Gives tabs to the ends of strips that lie on the critical graph, on one of the two sides that
// meet there: along each arc to the ends of rings where f grows, then to those of the lower
// cylinder; between rectangles to the one where g grows. Ends on the boundary of the surface have
// none. Conforming strips (Strip::next) are left alone.
//
// Throws Error(SelfCheck) as geometry::find_arcs and find_sides.
void glue_ends(const geometry::QuadMesh& mesh,
               const geometry::Foliation& foliation,
               std::span<Strip> strips);

}  // namespace leafcutter::fab
