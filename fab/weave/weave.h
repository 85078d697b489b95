// Which thread lies on top where weft and warp cross: the weave.

#pragma once

#include <cstdint>
#include <vector>

#include "fab/job_params.h"
#include "fab/strips/strip.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

struct Weave {
    std::vector<std::uint8_t> warp_on_top;  // Per quad, 0 or 1.
    std::vector<std::array<int, 2>> seams;  // Neighbouring quads where the pattern breaks.
    double seam_mm = 0.0;                   // Length of the edges between them.
    bool shortest = true;  // Proven: no other beginnings of the pattern, one in each cylinder,
                           // break it between fewer neighbours.
};

Weave weave_cells(const geometry::QuadMesh& mesh, const WeaveParams& params);

// Of columns: round a closed row a multiple of it lets the pattern go on.
int pattern_period(const WeaveParams& params);

}  // namespace leafcutter::fab
