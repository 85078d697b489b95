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

struct RectangleBorder {
    std::span<const int> loop;  // The boundary, surface to the left.
    LoopCorners corners{};  // In the loop's direction; f = 0 between the first two, f = 1 between
                            // the others.
    std::span<const double> f = {};  // Per vertex, to be held along the other two sides, rising;
                                     // empty for natural sides.
};

// The same with given corners.
Foliation foliate_rectangle(const TriangleMesh& mesh,
                            const RectangleBorder& border,
                            const FoliationOptions& options,
                            const Context& context);

}  // namespace leafcutter::geometry
