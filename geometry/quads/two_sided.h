// The distance between quad mesh and surface, measured from both sides: what the quads stand off
// the surface, and what of the surface the quads leave out.

#pragma once

#include <vector>

#include "geometry/context.h"
#include "geometry/quads/quality.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

// In percent of the diagonal of the surface's bounding box: the largest distance, and the mean over
// the area that is measured from.
struct TwoSidedDistance {
    MaxAvg quads_to_surface;
    MaxAvg surface_to_quads;
    MaxAvg both;  // The larger maximum (the Hausdorff distance), the mean of both means.
};

// `cells` are those of the mesh, as measured by measure_cells(). The surface is sampled at its
// vertices and in parts of its triangles at most half a cell long. The same on any number of
// threads.
TwoSidedDistance measure_two_sided(const QuadMesh& mesh,
                                   const std::vector<CellQuality>& cells,
                                   const TriangleMesh& surface,
                                   const Context& context = {});

}  // namespace leafcutter::geometry
