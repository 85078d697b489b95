#include "fab/cut/segment_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace leafcutter::fab {

SegmentGrid::SegmentGrid(std::span<const Segment> segments)
    : segments_(segments), low_(segments.front().from) {
    Eigen::Vector2d high = low_;
    for (const Segment& segment : segments) {
        low_ = low_.cwiseMin(segment.from).cwiseMin(segment.to);
        high = high.cwiseMax(segment.from).cwiseMax(segment.to);
    }
    const Eigen::Vector2d size = (high - low_).array() + 1e-9;
    cell_mm_ = std::max(std::sqrt(size.x() * size.y() / static_cast<double>(segments.size())),
                        size.maxCoeff() / 500.0);
    columns_ = static_cast<int>(size.x() / cell_mm_) + 1;
    rows_ = static_cast<int>(size.y() / cell_mm_) + 1;
    cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const Segment& segment = segments[i];
        const Eigen::Vector2d from = segment.from.cwiseMin(segment.to);
        const Eigen::Vector2d to = segment.from.cwiseMax(segment.to);
        for (int y = row(from.y()); y <= row(to.y()); ++y) {
            for (int x = column(from.x()); x <= column(to.x()); ++x) {
                const Eigen::Vector2d middle = low_ + cell_mm_ * Eigen::Vector2d(x + 0.5, y + 0.5);
                if (squared_distance(middle, segment) <= 0.5001 * cell_mm_ * cell_mm_) {
                    cells_[cell_at(x, y)].push_back(i);
                }
            }
        }
    }
}

int SegmentGrid::column(double x) const {
    return static_cast<int>(
        std::clamp(std::floor((x - low_.x()) / cell_mm_), 0.0, static_cast<double>(columns_ - 1)));
}

int SegmentGrid::row(double y) const {
    return static_cast<int>(
        std::clamp(std::floor((y - low_.y()) / cell_mm_), 0.0, static_cast<double>(rows_ - 1)));
}

double SegmentGrid::least_square_in(int x, int y, const Eigen::Vector2d& point) const {
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t i : cells_[cell_at(x, y)]) {
        least = std::min(least, squared_distance(point, segments_[i]));
    }
    return least;
}

double SegmentGrid::distance(const Eigen::Vector2d& point) const {
    const int x0 = column(point.x());
    const int y0 = row(point.y());
    const int most = std::max(columns_, rows_);
    double least = std::numeric_limits<double>::infinity();
    for (int ring = 0; ring <= most; ++ring) {
        for (int y = std::max(0, y0 - ring); y <= std::min(rows_ - 1, y0 + ring); ++y) {
            const int step = std::abs(y - y0) == ring || ring == 0 ? 1 : 2 * ring;
            for (int x = x0 - ring; x <= x0 + ring; x += step) {
                if (x >= 0 && x < columns_) {
                    least = std::min(least, least_square_in(x, y, point));
                }
            }
        }
        // Nothing in the rings further out is nearer than this.
        const double reach = ring * cell_mm_;
        if (least <= reach * reach) {
            break;
        }
    }
    return std::sqrt(least);
}

}  // namespace leafcutter::fab
