// Joins faces that a file stores apart: equal positions along open edges. Internal to geometry.

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/edge_table.h"

namespace leafcutter::geometry {

struct WeldResult {
    std::vector<std::uint32_t> representative;  // Per vertex: the vertex that stands for it.
    std::size_t welded_vertices = 0;
    std::size_t degenerate_faces = 0;  // Dropped.
    std::size_t duplicate_faces = 0;   // Dropped.
    std::size_t slits = 0;             // Boundaries that lie on themselves and were kept so.
};

// Rewrites `triangles` to use the representatives.
//
// Only open edges are touched: two open edges whose ends lie at equal positions become one; what is
// left open is tried again with a tolerance of a millionth of its bounding box, where exactly two
// edges meet head to tail and no non-manifold edge comes of it. Faces that stand all alone and
// repeat another one, or have two corners in one place, are dropped. A closed mesh is left as it
// is, but for edges of length 0, which are contracted.
//
// Throws Error(BadMesh, "degenerate") if an edge of length 0 can't be contracted.
WeldResult weld(std::span<const Eigen::Vector3d> positions, std::vector<Triangle>& triangles);

}  // namespace leafcutter::geometry
