// The rectangles that a surface cut along the leaves of a one-form falls into.

#pragma once

#include <array>
#include <vector>

#include "geometry/harmonic/leaf_cut.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

struct FormPart {
    TriangleMesh mesh;               // Points on a cut have a copy for each side.
    std::vector<int> source_vertex;  // Of the cut surface.
    std::vector<int> source_triangle;
    std::vector<int> loop;         // Its boundary, surface to the left,
    std::vector<int> loop_edge;    // and the half-edges of the cut surface along it.
    std::array<int, 4> corners{};  // Places in `loop`: the ends of the source side, then those of
                                   // the sink side.
    double flux = 0.0;             // Rise of g along the source side.
};

// In the order of their source sides along the boundary.
// Throws Error(SelfCheck, "one-form") if a part is not a disk with one side on a source and one on
// a sink.
std::vector<FormPart> separate_parts(const CutSurface& cut);

}  // namespace leafcutter::geometry
