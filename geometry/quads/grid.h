// The grid of one chart: how many rows and columns, at which levels, and how it closes.
//
// On a torus the second period (shear, height) need not be a whole number of columns aside. The
// grid is then slanted by a little, so that row `rows` falls on row 0, `column_shift` columns
// further on. "Straight" coordinates (s, f) take the slant out: s = g - slant f. In them cells are
// axis-parallel.
//
// On a pillowcase the upper fold is slanted onto a column in the same way. Then columns are sewn
// onto columns at both folds: the grid has no boundary, and threads of both families close. Columns
// lie symmetrically about the folds, so a vertex on a fold is the same point from both sides.

#pragma once

#include <cstddef>
#include <limits>
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
    int period =
        2;  // Of the weave's pattern: with Parity::Even it should close, if it costs little.
    // Of cells, how much longer than wide or wider than long they may be, as a logarithm. Not for
    // fixed counts.
    double most_stretch = std::numeric_limits<double>::infinity();
    std::string path = "grid";  // Of `counts` in the job's parameters, for messages.
};

// Squares on the surface, on average: as many as wished, evenly wide (spacing.h) and as little
// slanted as possible. Throws Error(BadOption) naming the count that is impossible and the least
// that would do.
CylinderGrid choose_grid(const Cylinder& chart, const GridWish& wish);

// How many more cells than area / width² a chart has with strips of that width in the mean, where
// they are wide and narrow by turns.
double cells_per_square(const Cylinder& chart);

// Levels of columns made symmetric about the fold at level 0, and so about the one half round.
std::vector<double> folded_levels(const std::vector<double>& levels);

// Index arithmetic and coordinates of a chart's grid.
class ChartGrid {
public:
    // Refers to nothing but copies what it needs.
    ChartGrid(const Cylinder& chart, CylinderGrid grid);

    const CylinderGrid& grid() const { return grid_; }
    bool closed_across() const { return grid_.shape != ChartShape::Rectangle; }  // In g.
    bool closed_along() const { return grid_.shape == ChartShape::Torus; }       // In f.
    bool has_folds() const { return grid_.shape == ChartShape::Pillowcase; }

    // Rows and columns of vertices without repetition: those of a row are its columns
    // first_col(row) to first_col(row) + vertices_in(row) - 1, numbered on from row to row.
    int vertex_rows() const { return grid_.rows + (closed_along() ? 0 : 1); }
    int first_col(int row) const {
        return has_folds() && row == grid_.rows ? grid_.column_shift : 0;
    }
    int vertices_in(int row) const;
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
    bool on_fold(int row) const { return has_folds() && (row == 0 || row == grid_.rows); }

    CylinderGrid grid_;
    double width_ = 1.0;
    double height_ = 1.0;
    double slant_ = 0.0;
};

}  // namespace leafcutter::geometry
