// Sizes of a triangle surface.

#pragma once

#include "geometry/types.h"

namespace leafcutter::geometry {

double surface_area(const TriangleMesh& mesh);

// Of the bounding box of its vertices; 0 for none.
double diagonal(const TriangleMesh& mesh);

}  // namespace leafcutter::geometry
