// Moves a vertex of a graph-valued map to the place of a neighbour in the tree; a homotopy.

#pragma once

#include "geometry/pants/tree_word.h"
#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

// Afterwards the word between the two is empty and `v` is where `neighbour` is. Right only where
// neighbours of `v` beyond a node that are apart round `v` are apart in the tree, as at the nodes
// of a first map.
// Throws Error(SelfCheck, "broken-tree") if they aren't neighbours or no end is found.
void draw_onto(GraphMap& map, const VertexRings& rings, int v, int neighbour);

}  // namespace leafcutter::geometry
