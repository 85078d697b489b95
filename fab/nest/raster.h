// A sheet as bits, 64 positions to a word: finds where a piece may lie by trying a whole row of
// positions at once. It only proposes: collision.h decides.

#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "fab/nest/shape.h"

namespace leafcutter::fab {

// The raster points that a piece covers, relative to the lower left corner of its bounds, in an
// order in which each prefix is spread over the whole piece: a blocked position shows early.
struct Stencil {
    struct Cell {
        int x = 0;
        int y = 0;
    };
    std::vector<Cell> cells;
    int width = 0;   // Largest x.
    int height = 0;  // Largest y.
};

// `ring` has the lower left corner of its bounds at the origin.
Stencil make_stencil(const Ring& ring, double cell_mm);

class SheetRaster {
public:
    // Raster points lie at multiples of cell_mm in [0, extent].
    SheetRaster(const Eigen::Vector2d& extent, double cell_mm);

    double cell_mm() const { return cell_mm_; }
    int columns() const { return columns_; }
    int rows() const { return rows_; }

    // Blocks every point within `reach_mm` of the ring or inside it.
    void block(const Ring& ring, double reach_mm);

    // Positions 0..last of the stencil's corner in row `row`: bit set = blocked. Returns false if
    // all are blocked; `blocked` is then unspecified. Needs row + stencil.height < rows() and last
    // + stencil.width < columns().
    bool free_positions(const Stencil& stencil,
                        int row,
                        int last,
                        std::vector<std::uint64_t>& blocked) const;

private:
    struct Span {
        double from = 0.0;
        double to = 0.0;
    };

    void block_span(int row, const Span& x_mm);
    void block_capsule(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double reach_mm);
    void block_inside(const Ring& ring);

    double cell_mm_;
    int columns_;
    int rows_;
    std::size_t stride_;  // Words to a row, with one spare for reading across the end.
    std::vector<std::uint64_t> bits_;
};

}  // namespace leafcutter::fab
