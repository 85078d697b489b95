// A topological disk with four boundary points becomes a rectangle (section 3.6.2).
//
// The paper doubles the disk along two opposite sides; the symmetric solution on the double is, on
// the half, the harmonic function with values on those sides and natural conditions on the others.

#pragma once

#include <span>

#include "geometry/foliation.h"

namespace leafcutter::geometry {

// `loop` is the boundary, surface to the left. f rises along the longer pair of sides.
// Throws as compute_foliation does.
Foliation foliate_disk(const TriangleMesh& mesh,
                       std::span<const int> loop,
                       const FoliationOptions& options,
                       const Context& context);

}  // namespace leafcutter::geometry
