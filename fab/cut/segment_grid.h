// Distance from a point to the nearest of many segments, from a uniform grid.

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fab/nest/collision.h"

namespace leafcutter::fab {

class SegmentGrid {
public:
    // `segments` is not empty and outlives the grid.
    explicit SegmentGrid(std::span<const Segment> segments);

    double distance(const Eigen::Vector2d& point) const;

private:
    std::size_t cell_at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(x);
    }
    double least_square_in(int x, int y, const Eigen::Vector2d& point) const;
    int column(double x) const;
    int row(double y) const;

    std::span<const Segment> segments_;
    Eigen::Vector2d low_;
    double cell_mm_ = 1.0;
    int columns_ = 1;
    int rows_ = 1;
    std::vector<std::vector<std::size_t>> cells_;
};

}  // namespace leafcutter::fab
