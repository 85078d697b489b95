// Nearest points in the plane, from a uniform grid. Points can be taken out.

#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace leafcutter::fab {

class PointGrid {
public:
    explicit PointGrid(const std::vector<Eigen::Vector2d>& points);

    void remove(std::size_t point);

    // The nearest point left; there must be one. Of equally near ones the lowest number.
    std::size_t nearest(const Eigen::Vector2d& to) const;

    // Up to `count` nearest points, nearest first.
    std::vector<std::size_t> nearest(const Eigen::Vector2d& to, std::size_t count) const;

    // Up to `count` points nearest to `point` whose owner is another, one per owner, nearest first.
    std::vector<std::size_t> nearest_others(std::size_t point,
                                            const std::vector<std::size_t>& owner,
                                            std::size_t count) const;

private:
    // Points in the cells of one square ring round a cell.
    void collect_ring(int x0, int y0, int ring, std::vector<std::size_t>& out) const;
    const std::vector<std::size_t>& cell(int x, int y) const;
    int column(double x) const;
    int row(double y) const;

    std::vector<Eigen::Vector2d> points_;
    Eigen::Vector2d low_;
    double cell_mm_ = 1.0;
    int columns_ = 1;
    int rows_ = 1;
    std::vector<std::vector<std::size_t>> cells_;
};

}  // namespace leafcutter::fab
