// How good a quad mesh is: the paper's three measures (section 5), with their bounds.

#pragma once

#include <vector>

#include "geometry/closest_point.h"
#include "geometry/context.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

struct MaxAvg {
    double max = 0.0;
    double avg = 0.0;
};

struct Quality {
    int quads = 0;
    MaxAvg angle_deviation_deg;              // Per vertex, mean |corner − 90| over its corners.
    double angle_deviation_bound_deg = 0.0;  // Least average the formula allows on these leaves.
    MaxAvg crossing_angle_deviation_deg;  // Regular interior vertices: chords through neighbours.
    MaxAvg surface_distance_percent;  // Largest distance of the bilinear patch / mean leaf length.
    double area_distortion_percent = 0.0;  // |quad − region| / region, averaged.
    MaxAvg planarity_percent;              // Distance between the diagonals / their mean length.
    double cell_area_variation = 0.0;      // Standard deviation / mean of the cells' areas.
    double largest_cell_edge = 0.0;        // Largest sqrt(region area), in mean cell edges.
};

struct QualityReport {
    Quality overall;
    std::vector<Quality> per_cylinder;
    double removed_area_percent = 0.0;  // Of the surface: parts that no quad comes near (limbs that
                                        // one cell swallowed), see quality.cpp.
};

QualityReport measure_quality(const QuadMesh& mesh,
                              const ClosestPoint& surface,
                              const Context& context = {});

}  // namespace leafcutter::geometry
