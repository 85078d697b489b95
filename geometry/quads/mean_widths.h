// How wide strips are on average.

#pragma once

#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

// Of each family the area of the surface over the length of all its strips along the middle. Strips
// of weft are rows, those of warp columns.
struct MeanWidths {
    double weft_mm = 0.0;
    double warp_mm = 0.0;

    // Of both families together.
    double all_mm() const { return 2.0 / (1.0 / weft_mm + 1.0 / warp_mm); }
};

// `mesh` has at least one quad.
MeanWidths mean_widths(const QuadMesh& mesh);

}  // namespace leafcutter::geometry
