// Splits interior edges whose two ends are mapped to one straight boundary line, so that no
// triangle is pressed flat between them.

#pragma once

#include <cstdint>
#include <vector>

#include "geometry/types.h"

namespace leafcutter::geometry {

struct SplitMesh {
    TriangleMesh mesh;                // The given vertices first, then the midpoints.
    std::vector<int> source_vertex;   // Identity, then -1 for each midpoint.
    std::vector<std::uint8_t> lines;  // As given, then 0.
};

// `lines` has for each vertex a bit for every boundary line it lies on.
SplitMesh split_chords(TriangleMesh mesh, std::vector<std::uint8_t> lines);

}  // namespace leafcutter::geometry
