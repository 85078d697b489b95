// Ways along the edges of a surface.

#pragma once

#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

// The edge that joins two vertices. Throws Error(SelfCheck, "no-such-edge") if none does.
int find_edge(const VertexRings& rings, int a, int b);

}  // namespace leafcutter::geometry
