// The quad mesh: where leaves of F and F* cross, at a wanted strip width.
//
// Corners a b c d of a quad: a→b and d→c run along leaves of F (g grows), a→d and b→c along leaves
// of F* (f grows); counter-clockwise seen from outside. Rows run along F: row i lies between the
// f-levels i and i+1; column j between the g-levels j and j+1.

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry/context.h"
#include "geometry/foliation.h"

namespace leafcutter::geometry {

// Uniform: strips as evenly wide on the surface as the leaves allow. Curvature: narrower where the
// surface bends across them, on average over a leaf; CurvatureArea: on average over its area.
// Graded grids are taken only where they lower the largest distance to the surface.
enum class Spacing { Uniform, Curvature, CurvatureArea };
enum class Junctions { Conforming, Independent };
enum class Parity { Even, Any };
enum class Planarity { Off, Gentle, Full };

struct RowsCols {
    std::optional<int> rows;
    std::optional<int> cols;
};

struct GridOptions {
    double strip_width_mm = 10.0;        // Mean width of strips: cells = area / width².
    bool may_narrow = true;              // Narrower strips rather than none, where it must be.
    RowsCols all;                        // Fixed counts for every cylinder, instead of the width.
    std::vector<RowsCols> per_cylinder;  // Stronger than `all`; may be shorter than the cylinders.
    Spacing spacing = Spacing::Uniform;
    Junctions junctions = Junctions::Conforming;
    Parity parity = Parity::Even;
    int period = 2;  // Of the weave's pattern: with Parity::Even columns that close are a multiple
                     // of it, where cylinders are joined.
    Planarity planar = Planarity::Off;
    bool even_cells = false;
    bool half_sag_offset = true;  // Moves vertices half a sagitta off the surface, so that chord
                                  // errors lie evenly on both sides.
};

struct QuadAddress {
    int cylinder = 0;
    int row = 0;
    int col = 0;
};

struct CylinderGrid {
    ChartShape shape = ChartShape::Rectangle;
    int rows = 0;
    int cols = 0;
    // Torus: row `rows` continues row 0 this many columns further on: vertex (rows, j) is vertex
    // (0, j - column_shift). Pillowcase: vertex (rows, j) is vertex (rows, 2 column_shift - j), as
    // (0, j) is (0, -j).
    int column_shift = 0;
    double shear_deg = 0.0;  // Angle by which the grid leaves orthogonality to close, or to
                             // meet its neighbours: 0 if it does neither.
    double stretch = 1.0;    // Mean height of its cells over their mean width, on the surface.
    std::vector<double> f_levels;  // rows + 1
    std::vector<double> g_levels;  // cols + 1
};

// What planarising reached and cost.
struct PlanarisationPrice {
    // As quality.h defines them, over the whole mesh, against the foliation's charts.
    struct Figures {
        double planarity_max_percent = 0.0;
        double planarity_avg_percent = 0.0;
        double angle_deviation_avg_deg = 0.0;
        double surface_distance_max_percent = 0.0;
        double surface_distance_avg_percent = 0.0;
        double area_distortion_avg_percent = 0.0;
    };
    Planarity wanted = Planarity::Off;
    bool reached = false;  // Full: every cell; Gentle: as far as its angle allows.
    Figures before;
    Figures after;
    double cell_area_change_avg_percent = 0.0;  // Of a cell against itself before.
    double largest_displacement_mm = 0.0;
    double mean_displacement_mm = 0.0;
    int iterations = 0;
};

struct QuadMesh {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<std::array<int, 4>> quads;
    std::vector<QuadAddress> addresses;  // Per quad. Quads are sorted by (cylinder, row, col).
    std::vector<CylinderGrid> grids;     // Per cylinder.

    // The charts that were sampled, where those of the foliation were changed so that columns go on
    // from one into the next (Junctions::Conforming); else empty.
    std::vector<Cylinder> charts;

    std::vector<std::string> warnings;

    std::optional<PlanarisationPrice> planarisation;  // With GridOptions::planar.

    // Per quad the area of the surface it stands for: the part of the chart inside its cell, mm².
    std::vector<double> surface_area;
};

// Samples the foliation's charts. Vertices are shared inside a cylinder; with Junctions::Conforming
// also between cylinders that are rings of one foliation by pants, along their critical leaves.
//
// Throws Error(BadOption) for an impossible count, or strips too wide to go on from one cylinder
// into the next (saying how wide they may be), and Error(SelfCheck) where the grid is not
// manifold, or a quad is inverted.
QuadMesh build_quad_mesh(const Foliation& foliation,
                         const GridOptions& options = {},
                         const Context& context = {});

}  // namespace leafcutter::geometry
