// What is measured quad by quad: the paper's surface distance and area distortion (section 5.2),
// planarity and shape.

#pragma once

#include <span>
#include <vector>

#include "geometry/closest_point.h"
#include "geometry/context.h"
#include "geometry/quads/quad_mesh.h"
#include "geometry/quads/threads.h"

namespace leafcutter::geometry {

// A quad is measured as the bilinear patch through its corners. Lengths in units of the mesh.
struct CellQuality {
    double distance = 0.0;          // Largest from patch to surface.
    double mean_distance = 0.0;     // Over the patch.
    double distance_percent = 0.0;  // `distance` over the mean length of the two leaves through it.
    double area = 0.0;
    double projected_area = 0.0;  // What the patch projects to on the surface, by closest points.
    double area_percent = 0.0;    // |area − projected| / projected.
    double region_area = 0.0;     // The part of the chart that it stands for.
    double region_percent = 0.0;  // |area − region| / region: says where a cell caps a limb.
    double planarity_percent = 0.0;     // Distance between the diagonals / their mean length.
    double corner_deviation_deg = 0.0;  // Mean |corner − 90| over its own four corners.
    double stretch = 1.0;               // Height (along warp) over width (along weft).
    double shear_deg = 0.0;             // Angle between its middle lines − 90.
};

// One for each quad; `leaves` as of measure_quality(). The same on any number of threads.
std::vector<CellQuality> measure_cells(const QuadMesh& mesh,
                                       const ClosestPoint& surface,
                                       std::span<const Thread> leaves,
                                       const Context& context = {});

}  // namespace leafcutter::geometry
