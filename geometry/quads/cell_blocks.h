// Normal equations of a quad mesh whose unknowns are its vertices: 3 × 3 blocks, one for each two
// vertices of a cell.

#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/sparse_solver.h"

namespace leafcutter::geometry {

class CellBlocks {
public:
    CellBlocks(std::size_t vertices, std::span<const std::array<int, 4>> quads);

    void clear();
    void add_vertex(std::size_t vertex, const Eigen::Matrix3d& block);

    // Rows and columns of `block` by the corners of the cell.
    void add_cell(std::size_t cell, const Eigen::Matrix<double, 12, 12>& block);

    const SymmetricMatrix& matrix() const { return matrix_; }

private:
    // Where the block of two vertices begins in `value`, and how far its columns are apart.
    struct Place {
        int first = -1;
        int step = 0;
    };
    void add(const Place& place, const Eigen::Matrix3d& block, bool diagonal);

    SymmetricMatrix matrix_;
    std::vector<Place> diagonal_;               // Per vertex.
    std::vector<std::array<Place, 16>> cells_;  // Per cell, row-major: lower triangle only.
    std::vector<std::array<int, 4>> quads_;
};

}  // namespace leafcutter::geometry
