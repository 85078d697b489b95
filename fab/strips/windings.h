// Closed strips that wind through a chart again and again: on twisted tori and pillowcases.

#pragma once

#include <vector>

#include "fab/strips/strip.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

// The cells of a closed strip before which it has to be parted because it winds: it passes the line
// where its chart closes (of a torus from the last row to the first one, of a pillowcase the fold
// behind the last row) more than once. In one piece it would be held on all windings but its ends,
// and have to be threaded everywhere. Ascending; empty if it passes there once at most.
std::vector<int> winding_joints(const geometry::QuadMesh& mesh, const Strip& strip);

}  // namespace leafcutter::fab
