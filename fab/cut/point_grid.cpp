#include "fab/cut/point_grid.h"

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

void PointGrid::collect_ring(int x0, int y0, int ring, std::vector<std::size_t>& out) const {
    for (int y = std::max(0, y0 - ring); y <= std::min(rows_ - 1, y0 + ring); ++y) {
        const bool whole_row = std::abs(y - y0) == ring;
        for (int x = x0 - ring; x <= x0 + ring; x += whole_row ? 1 : 2 * ring) {
            if (x >= 0 && x < columns_) {
                out.insert(out.end(), cell(x, y).begin(), cell(x, y).end());
            }
        }
    }
}

std::vector<std::size_t> PointGrid::nearest(const Eigen::Vector2d& to, std::size_t count) const {
    std::vector<std::pair<double, std::size_t>> found;
    const int x0 = column(to.x());
    const int y0 = row(to.y());
    const int most = std::max(columns_, rows_);
    std::vector<std::size_t> ring_points;
    for (int ring = 0; ring <= most; ++ring) {
        ring_points.clear();
        collect_ring(x0, y0, ring, ring_points);
        for (const std::size_t point : ring_points) {
            found.emplace_back((points_[point] - to).squaredNorm(), point);
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

std::vector<std::size_t> PointGrid::nearest_others(std::size_t point,
                                                   const std::vector<std::size_t>& owner,
                                                   std::size_t count) const {
    const Eigen::Vector2d& at = points_[point];
    const int x0 = column(at.x());
    const int y0 = row(at.y());
    const int most = std::max(columns_, rows_);
    std::vector<std::pair<double, std::size_t>> found;
    std::vector<std::size_t> ring_points;
    std::vector<std::size_t> out;
    for (int ring = 0; ring <= most; ++ring) {
        ring_points.clear();
        collect_ring(x0, y0, ring, ring_points);
        for (const std::size_t other : ring_points) {
            if (owner[other] != owner[point]) {
                found.emplace_back((points_[other] - at).squaredNorm(), other);
            }
        }
        std::sort(found.begin(), found.end());
        const double reach = ring * cell_mm_;
        out.clear();
        std::vector<std::size_t> owners;
        for (const auto& [square, other] : found) {
            const bool sure = square <= reach * reach || ring == most;
            if (sure && out.size() < count &&
                std::find(owners.begin(), owners.end(), owner[other]) == owners.end()) {
                owners.push_back(owner[other]);
                out.push_back(other);
            }
        }
        if (out.size() == count) {
            break;
        }
    }
    return out;
}

}  // namespace leafcutter::fab
