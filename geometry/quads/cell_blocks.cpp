#include "geometry/quads/cell_blocks.h"

#include <algorithm>

namespace leafcutter::geometry {

namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Per vertex those of the same cells with a higher number, ascending.
std::vector<std::vector<int>> higher_neighbours(std::size_t vertices,
                                                std::span<const std::array<int, 4>> quads) {
    std::vector<std::vector<int>> higher(vertices);
    for (const auto& quad : quads) {
        for (const int low : quad) {
            for (const int high : quad) {
                if (high > low) {
                    higher[at(low)].push_back(high);
                }
            }
        }
    }
    for (std::vector<int>& list : higher) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
    return higher;
}

}  // namespace

CellBlocks::CellBlocks(std::size_t vertices, std::span<const std::array<int, 4>> quads)
    : diagonal_(vertices), cells_(quads.size()), quads_(quads.begin(), quads.end()) {
    const std::vector<std::vector<int>> higher = higher_neighbours(vertices, quads);
    matrix_.size = static_cast<int>(3 * vertices);
    matrix_.column_start.push_back(0);
    // Column k of a vertex: rows k … 2 of its own block, then whole blocks of higher vertices.
    for (std::size_t v = 0; v < vertices; ++v) {
        for (int k = 0; k < 3; ++k) {
            for (int row = k; row < 3; ++row) {
                matrix_.row.push_back(3 * static_cast<int>(v) + row);
            }
            for (const int other : higher[v]) {
                for (int row = 0; row < 3; ++row) {
                    matrix_.row.push_back(3 * other + row);
                }
            }
            matrix_.column_start.push_back(static_cast<int>(matrix_.row.size()));
        }
        diagonal_[v] = {.first = matrix_.column_start[3 * v],
                        .step = 3 * static_cast<int>(higher[v].size())};
    }
    matrix_.value.assign(matrix_.row.size(), 0.0);
    for (std::size_t cell = 0; cell < quads.size(); ++cell) {
        for (std::size_t i = 0; i < 16; ++i) {
            const int row = quads[cell][i / 4];
            const int column = quads[cell][i % 4];
            const Place& own = diagonal_[at(column)];
            if (row == column) {
                cells_[cell][i] = own;
            } else if (row > column) {
                const std::vector<int>& list = higher[at(column)];
                const auto found = std::lower_bound(list.begin(), list.end(), row);
                cells_[cell][i] = {
                    .first = own.first + 3 + 3 * static_cast<int>(found - list.begin()),
                    .step = own.step};
            }
        }
    }
}

void CellBlocks::clear() {
    std::fill(matrix_.value.begin(), matrix_.value.end(), 0.0);
}

void CellBlocks::add(const Place& place, const Eigen::Matrix3d& block, bool diagonal) {
    // The own blocks lose a row with every column: columns of entries 3, 2, 1 lie before the rest.
    int column_begin = place.first;
    for (int column = 0; column < 3; ++column) {
        for (int row = diagonal ? column : 0; row < 3; ++row) {
            const int offset = diagonal ? row - column : row;
            matrix_.value[at(column_begin + offset)] += block(row, column);
        }
        column_begin += place.step + (diagonal ? 3 - column : 2 - column);
    }
}

void CellBlocks::add_vertex(std::size_t vertex, const Eigen::Matrix3d& block) {
    add(diagonal_[vertex], block, true);
}

void CellBlocks::add_cell(std::size_t cell, const Eigen::Matrix<double, 12, 12>& block) {
    for (std::size_t row = 0; row < 4; ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
            const Place& place = cells_[cell][4 * row + column];
            if (place.first >= 0) {
                add(place,
                    block.block<3, 3>(static_cast<Eigen::Index>(3 * row),
                                      static_cast<Eigen::Index>(3 * column)),
                    quads_[cell][row] == quads_[cell][column]);
            }
        }
    }
}

}  // namespace leafcutter::geometry
