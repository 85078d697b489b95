// Whether the words of a map into the dual tree fit together.

#pragma once

#include "geometry/pants/tree_word.h"
#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

// Whether the ways a-b, b-c and a-c can be the sides of a triangle in a tree: they branch at one
// point, or lie on one line.
bool words_fit(const Word& ab, const Word& bc, const Word& ac);

// How many darts the ways a-b and a-c, neither of them empty, have in common before they branch;
// -1 if the three don't fit.
int shared_darts(const Word& ab, const Word& bc, const Word& ac);

// A triangle whose words don't fit, or -1.
int find_misfit(const GraphMap& map, const VertexRings& rings);

}  // namespace leafcutter::geometry
