// Planar cells, as an option with its price (section 4.1 of the paper).

#pragma once

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

// Gentle: the average angle deviation may rise by this much, and all of it is used.
inline constexpr double kGentleAngleDeg = 0.3;

// Full: the largest distance between a cell's diagonals over their mean length.
inline constexpr double kFullPlanarity = 1e-3;

// Moves the vertices of a mesh that has its addresses, grids and surface areas, so that its cells
// become planar: as far as the angles allow (Gentle), or all of them (Full). A mesh that is planar
// enough for Full stays as it is. Which quads there are and which vertices they share never
// changes; no cell turns over or becomes concave. Vertices of boundaries slide along them.
//
// Fills mesh.planarisation, and scales mesh.surface_area as cells grow and shrink. Adds a warning
// where Full can't be reached; the mesh is then as planar as was found.
void planarise(QuadMesh& mesh,
               const Foliation& foliation,
               Planarity wanted,
               const Context& context = {});

}  // namespace leafcutter::geometry
