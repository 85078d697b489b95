// A topological disk with four boundary points becomes a rectangle (section 3.6.2).
//
// The paper doubles the disk along two opposite sides; the symmetric solution on the double is, on
// the half, the harmonic function with values on those sides and natural conditions on the others.

#pragma once

#include <span>

#include "geometry/cases/corners.h"
#include "geometry/foliation.h"

namespace leafcutter::geometry {

// `loop` is the boundary, surface to the left. f rises along the longer pair of sides.
// Throws as compute_foliation does.
Foliation foliate_disk(const TriangleMesh& mesh,
                       std::span<const int> loop,
                       const FoliationOptions& options,
                       const Context& context);

// The same with f = 0 between the first two of `corners`, which are in the loop's direction, and
// f = 1 between the others.
Foliation foliate_rectangle(const TriangleMesh& mesh,
                            std::span<const int> loop,
                            const LoopCorners& corners,
                            const FoliationOptions& options,
                            const Context& context);

}  // namespace leafcutter::geometry
