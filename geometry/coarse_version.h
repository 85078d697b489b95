// A surface with fewer vertices and the same topology, to try things out on.

#pragma once

#include <cstddef>
#include <vector>

#include "geometry/context.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

struct CoarseVersion {
    TriangleMesh mesh;
    std::vector<int> source_vertex;  // Vertex of the surface given at the same place.
};

// The surface itself if it has no more than `most` vertices.
CoarseVersion coarse_version(const TriangleMesh& mesh, std::size_t most, const Context& context);

}  // namespace leafcutter::geometry
