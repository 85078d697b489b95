// Functions whose Reeb graphs give pants decompositions.

#pragma once

#include <span>
#include <vector>

#include "geometry/foliation.h"
#include "geometry/pants/decomposition.h"

namespace leafcutter::geometry {

struct SweepValues {
    std::vector<double> values;     // Per vertex.
    std::vector<char> loop_is_low;  // Per boundary loop: it is lowest of all, else highest.
};

// `function` is not Auto. Vertices of boundary loops get whatever the function has there.
// `attempt` > 0 varies where a harmonic function starts and ends, and tilts a coordinate.
SweepValues sweep_values(const DecompositionSurface& surface, SweepFunction function, int attempt);

}  // namespace leafcutter::geometry
