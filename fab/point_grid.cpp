#include "fab/point_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace leafcutter::fab {

PointGrid::PointGrid(const std::vector<Eigen::Vector2d>& points)
    : points_(points), low_(Eigen::Vector2d::Zero()) {
    if (points.empty()) {
        cells_.resize(1);
        return;
    }
    low_ = points.front();
    Eigen::Vector2d high = low_;
    for (const Eigen::Vector2d& point : points) {
        low_ = low_.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    const Eigen::Vector2d size = (high - low_).array() + 1e-9;
    // About two points to a cell, and no more than a few hundred cells a side.
    cell_mm_ = std::max(std::sqrt(size.x() * size.y() * 2.0 / static_cast<double>(points.size())),
                        size.maxCoeff() / 400.0);
    columns_ = static_cast<int>(size.x() / cell_mm_) + 1;
    rows_ = static_cast<int>(size.y() / cell_mm_) + 1;
    cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (std::size_t i = 0; i < points.size(); ++i) {
        const int at = row(points[i].y()) * columns_ + column(points[i].x());
        cells_[static_cast<std::size_t>(at)].push_back(i);
    }
}

int PointGrid::column(double x) const {
    return static_cast<int>(
        std::clamp(std::floor((x - low_.x()) / cell_mm_), 0.0, static_cast<double>(columns_ - 1)));
}

int PointGrid::row(double y) const {
    return static_cast<int>(
        std::clamp(std::floor((y - low_.y()) / cell_mm_), 0.0, static_cast<double>(rows_ - 1)));
}

const std::vector<std::size_t>& PointGrid::cell(int x, int y) const {
    return cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(x)];
}

void PointGrid::remove(std::size_t point) {
    const int at = row(points_[point].y()) * columns_ + column(points_[point].x());
    std::erase(cells_[static_cast<std::size_t>(at)], point);
}

std::size_t PointGrid::nearest(const Eigen::Vector2d& to) const {
    return nearest(to, 1).front();
}

std::vector<std::size_t> PointGrid::nearest(const Eigen::Vector2d& to, std::size_t count) const {
    std::vector<std::pair<double, std::size_t>> found;
    const int x0 = column(to.x());
    const int y0 = row(to.y());
    const int most = std::max(columns_, rows_);
    for (int ring = 0; ring <= most; ++ring) {
        for (int y = std::max(0, y0 - ring); y <= std::min(rows_ - 1, y0 + ring); ++y) {
            const bool whole_row = std::abs(y - y0) == ring;
            for (int x = x0 - ring; x <= x0 + ring; x += whole_row || ring == 0 ? 1 : 2 * ring) {
                if (x < 0 || x >= columns_) {
                    continue;
                }
                for (const std::size_t point : cell(x, y)) {
                    found.emplace_back((points_[point] - to).squaredNorm(), point);
                }
            }
        }
        // Whatever lies in rings further out is at least this far from a point within the grid.
        const double reach = ring * cell_mm_;
        std::sort(found.begin(), found.end());
        if (found.size() >= count && found[count - 1].first <= reach * reach) {
            break;
        }
    }
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < std::min(count, found.size()); ++i) {
        out.push_back(found[i].second);
    }
    return out;
}

}  // namespace leafcutter::fab
