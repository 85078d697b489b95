// The grid of one chart: how many rows and columns, at which levels, and how it closes.
//
// On a torus the second period (shear, height) need not be a whole number of columns aside. The
// grid is then slanted by a little, so that row `rows` falls on row 0, `column_shift` columns
// further on. "Straight" coordinates (s, f) take the slant out: s = g - slant f. In them cells are
// axis-parallel.

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry/foliation.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

struct GridWish {
    double cells = 1.0;  // Wanted number, if `counts` leaves it open.
    RowsCols counts;     // Fixed ones.
    Parity parity = Parity::Even;
    std::string path = "grid";  // Of `counts` in the job's parameters, for messages.
};

// Squares on the surface, on average: as many as wished, evenly wide (spacing.h) and as little
// slanted as possible. Throws Error(BadOption) naming the count that is impossible and the least
// that would do.
CylinderGrid choose_grid(const Cylinder& chart, const GridWish& wish);

// Index arithmetic and coordinates of a chart's grid.
class ChartGrid {
public:
    // Refers to nothing but copies what it needs.
    ChartGrid(const Cylinder& chart, CylinderGrid grid);

    const CylinderGrid& grid() const { return grid_; }
    bool closed_across() const { return grid_.shape != ChartShape::Rectangle; }  // In g.
    bool closed_along() const { return grid_.shape == ChartShape::Torus; }       // In f.

    // Rows and columns of vertices without repetition.
    int vertex_rows() const { return grid_.rows + (closed_along() ? 0 : 1); }
    int vertex_cols() const { return grid_.cols + (closed_across() ? 0 : 1); }
    int vertex(int row, int col) const;  // Wraps as the grid closes.
    int cell(int row, int col) const;

    // Straight level of a row or column of any index, periods included.
    double f_level(int row) const;
    double s_level(int col) const;
    // Largest index whose level is at most the value.
    int row_at(double f) const;
    int col_at(double s) const;

    Eigen::Vector2d straight(const Eigen::Vector2d& gf) const;
    Eigen::Vector2d unstraight(const Eigen::Vector2d& sf) const;

private:
    CylinderGrid grid_;
    double width_ = 1.0;
    double height_ = 1.0;
    double slant_ = 0.0;
};

}  // namespace leafcutter::geometry
