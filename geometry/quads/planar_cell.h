// What one cell asks of its corners while a quad mesh is made planar: to be flat, square, as long
// as it was, and to move as its neighbours do. Least squares: each wish is a row of a residual.

#pragma once

#include <array>

#include <Eigen/Core>

namespace leafcutter::geometry {

using CellCorners = std::array<Eigen::Vector3d, 4>;  // a b c d, as in quad_mesh.h.

// Rows: 4 angles, 4 lengths, 4 × 3 displacements along sides, 1 planarity.
inline constexpr int kCellRows = 21;
using CellResidual = Eigen::Matrix<double, kCellRows, 1>;
using CellJacobian = Eigen::Matrix<double, kCellRows, 12>;  // By a, b, c, d.

struct CellWishes {
    double planarity = 0.0;  // Weight of the twist, see twist_of().
    double pull = 0.0;       // Multiplier of the constraint "planar": augmented Lagrangian.
    double firmness = 1.0;   // Of angles and lengths, more where a cell would collapse.
};

// Fills `residual`, and `jacobian` unless it is null.
void cell_rows(const CellCorners& start,
               const CellCorners& corners,
               const CellWishes& wishes,
               CellResidual& residual,
               CellJacobian* jacobian);

// Distance between the diagonals over their mean length, with a sign. 0 for a cell of no area.
double bend_of(const CellCorners& corners);

// The smallest sine of its corners' angles, seen along the cell's normal: <= 0 for a concave cell.
double smallest_sine(const CellCorners& corners);

// The same against the width of thin cells: what the row of planarity weighs.
double twist_of(const CellCorners& corners);

// The smallest ratio of the length of a side to its length at the start.
double smallest_stretch(const CellCorners& start, const CellCorners& corners);

}  // namespace leafcutter::geometry
