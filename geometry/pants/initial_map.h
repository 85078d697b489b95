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
// `rings` are those of the surface without caps. Throws Error(SelfCheck, "pants-graph") if what is
// left is no graph of pants: 2g - 2 + b inner nodes counted with degree - 2, 3g - 3 + 2b edges.
GraphMap initial_map(const ReebGraph& reeb,
                     std::span<const double> values,
                     const VertexRings& rings,
                     std::span<const std::vector<int>> boundary_loops);

}  // namespace leafcutter::geometry
