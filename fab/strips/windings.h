// Warp threads that wind through a chart again and again: on twisted tori and pillowcases.

#pragma once

#include <vector>

#include "geometry/quads/quad_mesh.h"
#include "geometry/quads/threads.h"

namespace leafcutter::fab {

// Parts a closed thread that passes the line where its chart closes (of a torus from the last row
// to the first one, of a pillowcase the fold behind the last row) more than once, wherever it does.
// As one strip it would be held on all windings but its ends, and have to be threaded everywhere.
std::vector<geometry::Thread> parted_windings(const geometry::QuadMesh& mesh,
                                              geometry::Thread thread);

}  // namespace leafcutter::fab
