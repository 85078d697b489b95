// Any surface of negative Euler characteristic: cut into cylinders along the critical graph of the
// harmonic map to a pants decomposition's graph (sections 3.2 to 3.5, 3.6.3).
//
// An open surface needs no double: its boundary loops are held at end nodes of the graph, which by
// symmetry is the same map at half the size.

#pragma once

#include <vector>

#include "geometry/foliation.h"

namespace leafcutter::geometry {

// `loops` are all boundary loops, surface to the left.
Foliation foliate_pants(const TriangleMesh& mesh,
                        const std::vector<std::vector<int>>& loops,
                        const FoliationOptions& options,
                        const Context& context);

}  // namespace leafcutter::geometry
