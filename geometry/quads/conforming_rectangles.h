// One quad mesh across the rectangles of a one-form: they share the vertices on the leaves of F*
// between them.

#pragma once

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/quads/conforming_mesh.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

// Puts both together.
void merge_joined(JoinedMesh& mesh, JoinedMesh&& more);

// Eight quads meet at a zero with four prongs, four at all other vertices inside. Nothing if the
// foliation has no rectangles that meet.
// Throws Error(BadOption, "strips-too-wide") where so few quads can't carry the topology, or would
// face inwards, naming the widest strips that can.
JoinedMesh join_rectangles(const Foliation& foliation,
                           const GridOptions& options,
                           const Context& context);

}  // namespace leafcutter::geometry
