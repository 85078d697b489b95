// Splits mesh edges whose path in the tree passes more than one node, so that afterwards every
// triangle lies round at most one.

#pragma once

#include "geometry/pants/tree_word.h"
#include "geometry/pants/vertex_rings.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

// Splits an independent set of such edges, each inside a graph edge it passes whole. Returns how
// many; 0: none is left. New vertices come last; `rings` is rebuilt. Throws Error(SelfCheck,
// "broken-tree") if the words round a triangle don't fit together.
int split_long_edges(TriangleMesh& mesh, VertexRings& rings, GraphMap& map);

}  // namespace leafcutter::geometry
