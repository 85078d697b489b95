// An annulus becomes a cylinder of rings (section 3.6.1).
//
// The paper solves on the symmetric double, a torus. By symmetry its solution on the half is
// harmonic with constant values on the two boundary loops, and its conjugate has natural conditions
// there: half the size, the same map.

#pragma once

#include <array>
#include <vector>

#include "geometry/foliation.h"

namespace leafcutter::geometry {

// `loops` are the two boundary loops, surface to the left. f is 0 on the longer one.
Foliation foliate_annulus(const TriangleMesh& mesh,
                          const std::array<std::vector<int>, 2>& loops,
                          const FoliationOptions& options,
                          const Context& context);

// The same with f = 0 on the first loop, whatever their lengths.
Foliation foliate_ring(const TriangleMesh& mesh,
                       const std::array<std::vector<int>, 2>& rings,
                       const FoliationOptions& options,
                       const Context& context);

}  // namespace leafcutter::geometry
