// Which thread lies on top where weft and warp cross: the weave.

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "fab/job_params.h"
#include "fab/strips/strip.h"
#include "fab/weave/floats.h"
#include "fab/weave/pattern.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

struct Weave {
    std::vector<std::uint8_t> warp_on_top;  // Per quad, 0 or 1.
    std::vector<std::array<int, 2>> seams;  // Neighbouring quads where the pattern breaks; flips
                                            // of floats not counted.
    double seam_mm = 0.0;                   // Length of the edges between them.
    bool shortest = true;  // Proven: no other beginnings of the pattern, one in each cylinder,
                           // break it between fewer neighbours.
    Floats floats;
};

// Each cylinder takes the pattern as it goes on best into those that it is joined to: from any
// beginning, and turned by half where that makes another pattern, as charts may be that meet.
// Floats that are too long are broken then. Throws as float_limit.
Weave weave_cells(const geometry::QuadMesh& mesh, const WeaveParams& params);

}  // namespace leafcutter::fab
