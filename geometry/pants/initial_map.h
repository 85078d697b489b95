// From a Reeb graph to a first map into the dual tree of a pants decomposition (section 3.3, its
// steps 1 and 2).

#pragma once

#include <span>
#include <vector>

#include "geometry/pants/reeb_graph.h"
#include "geometry/pants/tree_word.h"
#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

// Prunes limbs that end in the surface, joins chains, and places vertices and mesh edges. Graph
// edges have weight 1. Vertices of boundary loop k are fixed at the graph's end node of that loop.
//
// `rings` are those of the surface that was swept, without what the sweep added. Throws
// Error(SelfCheck, "pants-graph") as check_pants_graph() does.
GraphMap initial_map(const ReebGraph& reeb,
                     const VertexRings& rings,
                     std::span<const std::vector<int>> boundary_loops);

}  // namespace leafcutter::geometry
