// Cells of even area on request: the foliation and the grid that even them out, beside those that
// don't.

#pragma once

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/mesh.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

struct EvenedOut {
    geometry::Foliation foliation;  // With `evened`: as measured on the quads of both.
    bool is_evened = false;         // Whether the grid is to be made with even cells.
};

// Foliates with and without even cells, builds both quad meshes, and keeps the one whose cells vary
// less. Throws as compute_foliation and build_quad_mesh do for the even one.
EvenedOut even_out(const geometry::Mesh& mesh,
                   const geometry::FoliationOptions& options,
                   const geometry::GridOptions& grid,
                   const geometry::Context& context);

}  // namespace leafcutter::fab
