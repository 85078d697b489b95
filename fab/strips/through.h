// Warp strips that run on through critical leaves, while they stay short and unfold well.

#pragma once

#include <vector>

#include "fab/job_params.h"
#include "fab/material/material.h"
#include "geometry/quads/quad_mesh.h"
#include "geometry/quads/threads.h"

namespace leafcutter::fab {

struct ThroughLimits {
    double max_length_mm = 900.0;    // Along the middle.
    double max_turning_deg = 270.0;  // Sum of the middle line's turns in the plane, either way.
    double self_gap_mm = 0.5;
    SheetSize usable_sheet{600.0, 400.0};
    Rotation rotation = Rotation::Free;
};

// The parts of a thread, each within the limits or between two leaves: as few as can be, parted at
// the leaves where it turns most. A thread without leaves stays whole.
std::vector<geometry::Thread> parted_at_leaves(const geometry::QuadMesh& mesh,
                                               geometry::Thread thread,
                                               const ThroughLimits& limits);

}  // namespace leafcutter::fab
