// How good a quad mesh is: the paper's three measures (section 5), with their bounds.
//
// The paper's average corner deviation lies below the least that its own formula allows on the
// leaves it draws. So three numbers are given: the formula, its bound (vertex_quality.h) and the
// angle at which leaves cross. The bound is of vertices inside, so that the formula is also given
// on those alone, and apart from them at the edge and in the corners of a disk, where no leaf can
// be moved.

#pragma once

#include <span>
#include <vector>

#include "geometry/closest_point.h"
#include "geometry/context.h"
#include "geometry/quads/cell_quality.h"
#include "geometry/quads/quad_mesh.h"
#include "geometry/quads/vertex_quality.h"

namespace leafcutter::geometry {

struct MaxAvg {
    double max = 0.0;
    double avg = 0.0;
};

// Over a set of quads and their vertices; vertices of which a quad isn't in the set are at its
// edge.
struct Quality {
    int quads = 0;
    MaxAvg angle_deviation_deg;              // Per vertex, mean |corner − 90| over its corners.
    MaxAvg angle_deviation_interior_deg;     // The same at vertices inside, also singular ones.
    MaxAvg angle_deviation_singular_deg;     // At those inside where not four quads meet.
    MaxAvg angle_deviation_boundary_deg;     // At the edge, without corners.
    MaxAvg angle_deviation_corner_deg;       // At the edge, where one quad alone ends.
    double angle_deviation_bound_deg = 0.0;  // Least average the formula allows on these leaves,
                                             // over the vertices inside.
    MaxAvg crossing_angle_deviation_deg;  // Regular interior vertices: chords through neighbours.
    MaxAvg surface_distance_percent;   // Largest distance of the bilinear patch / mean leaf length.
    MaxAvg distance_diagonal_percent;  // The same / diagonal of the surface's bounding box.
    double area_distortion_percent = 0.0;  // |quad − region| / region, averaged; region: what the
                                           // quad projects to on the surface.
    MaxAvg region_distortion_percent;      // The same with the part of the chart that the cell
                                           // stands for: also counts what cells cap.
    MaxAvg planarity_percent;              // Distance between the diagonals / their mean length.
    double cell_area_variation = 0.0;      // Standard deviation / mean of the cells' areas.
    double largest_cell_edge = 0.0;        // Largest sqrt(region area), in mean cell edges.
};

struct QualityReport {
    Quality overall;
    std::vector<Quality> per_cylinder;
    double removed_area_percent = 0.0;  // Of the surface: parts that no quad comes near (limbs that
                                        // one cell swallowed), see quality.cpp.
    std::vector<CellQuality> cells;     // Per quad.
    std::vector<VertexQuality> vertices;  // Per vertex, of all quads.
};

// Distances are related to the lengths of `leaves`, of both families, each quad in one of either;
// without them to leaves that end at critical leaves.
QualityReport measure_quality(const QuadMesh& mesh,
                              const ClosestPoint& surface,
                              const Context& context = {},
                              std::span<const Thread> leaves = {});

}  // namespace leafcutter::geometry
