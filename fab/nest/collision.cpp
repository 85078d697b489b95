#include "fab/nest/collision.h"

#include <algorithm>
#include <cmath>

#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::turn_of;

namespace {

bool cross_each_other(const Segment& a, const Segment& b) {
    const Eigen::Vector2d da = a.to - a.from;
    const Eigen::Vector2d db = b.to - b.from;
    const double a0 = turn_of(da, b.from - a.from);
    const double a1 = turn_of(da, b.to - a.from);
    const double b0 = turn_of(db, a.from - b.from);
    const double b1 = turn_of(db, a.to - b.from);
    return (a0 > 0.0) != (a1 > 0.0) && (b0 > 0.0) != (b1 > 0.0);
}

}  // namespace

double squared_distance(const Eigen::Vector2d& point, const Segment& segment) {
    const Eigen::Vector2d along = segment.to - segment.from;
    const double square = along.squaredNorm();
    const double t =
        square > 0.0 ? std::clamp((point - segment.from).dot(along) / square, 0.0, 1.0) : 0.0;
    return (segment.from + t * along - point).squaredNorm();
}

double squared_distance(const Segment& a, const Segment& b) {
    if (cross_each_other(a, b)) {
        return 0.0;
    }
    return std::min({squared_distance(a.from, b), squared_distance(a.to, b),
                     squared_distance(b.from, a), squared_distance(b.to, a)});
}

bool contains(const Ring& ring, const Eigen::Vector2d& point) {
    bool inside = false;
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
        const Eigen::Vector2d& a = ring[i];
        const Eigen::Vector2d& b = ring[j];
        if ((a.y() > point.y()) != (b.y() > point.y()) &&
            point.x() < a.x() + (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y())) {
            inside = !inside;
        }
    }
    return inside;
}

PlacedOutlines::PlacedOutlines(const Eigen::Vector2d& extent, double cell_mm)
    : cell_mm_(cell_mm),
      columns_(std::max(1, static_cast<int>(std::ceil(extent.x() / cell_mm)))),
      rows_(std::max(1, static_cast<int>(std::ceil(extent.y() / cell_mm)))),
      cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

PlacedOutlines::Range PlacedOutlines::cells_near(const Segment& segment, double reach_mm) const {
    const auto cell = [this](double at_mm, int count) {
        return static_cast<int>(
            std::clamp(std::floor(at_mm / cell_mm_), 0.0, static_cast<double>(count - 1)));
    };
    const Eigen::Vector2d low = segment.from.cwiseMin(segment.to);
    const Eigen::Vector2d high = segment.from.cwiseMax(segment.to);
    return {cell(low.x() - reach_mm, columns_), cell(high.x() + reach_mm, columns_),
            cell(low.y() - reach_mm, rows_), cell(high.y() + reach_mm, rows_)};
}

void PlacedOutlines::add(const Ring& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Segment segment{ring[i], ring[(i + 1) % ring.size()]};
        const Range range = cells_near(segment, 0.0);
        for (int y = range.y0; y <= range.y1; ++y) {
            for (int x = range.x0; x <= range.x1; ++x) {
                // A long slanted edge passes few of the cells in its bounds.
                const Eigen::Vector2d middle((x + 0.5) * cell_mm_, (y + 0.5) * cell_mm_);
                const bool edge_cell = x == 0 || y == 0 || x == columns_ - 1 || y == rows_ - 1;
                if (edge_cell ||
                    squared_distance(middle, segment) <= 0.5001 * cell_mm_ * cell_mm_) {
                    cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                           static_cast<std::size_t>(x)]
                        .push_back(segments_.size());
                }
            }
        }
        segments_.push_back(segment);
    }
    rings_.push_back(ring);
    boxes_.push_back(bounds(ring));
}

double PlacedOutlines::least_square(const Segment& segment, double limit_square) const {
    const double reach = std::sqrt(limit_square);
    const Range range = cells_near(segment, reach);
    const Eigen::Vector2d low = segment.from.cwiseMin(segment.to).array() - reach;
    const Eigen::Vector2d high = segment.from.cwiseMax(segment.to).array() + reach;
    double least = limit_square;
    for (int y = range.y0; y <= range.y1; ++y) {
        for (int x = range.x0; x <= range.x1; ++x) {
            for (const std::size_t index :
                 cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                        static_cast<std::size_t>(x)]) {
                const Segment& other = segments_[index];
                if (std::min(other.from.x(), other.to.x()) > high.x() ||
                    std::max(other.from.x(), other.to.x()) < low.x() ||
                    std::min(other.from.y(), other.to.y()) > high.y() ||
                    std::max(other.from.y(), other.to.y()) < low.y()) {
                    continue;
                }
                least = std::min(least, squared_distance(segment, other));
            }
        }
    }
    return least;
}

// Once no edges meet, one outline holds the other if it holds any vertex of it.
bool PlacedOutlines::overlaps_wholly(const Ring& ring, const Eigen::Vector2d& shift) const {
    Box box = bounds(ring);
    box.low += shift;
    box.high += shift;
    for (std::size_t i = 0; i < rings_.size(); ++i) {
        if (box.near(boxes_[i], 0.0) && (contains(rings_[i], ring.front() + shift) ||
                                         contains(ring, rings_[i].front() - shift))) {
            return true;
        }
    }
    return false;
}

bool PlacedOutlines::collides(const Ring& ring, const Eigen::Vector2d& shift, double gap_mm) const {
    const double limit = gap_mm * gap_mm;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Segment segment{ring[i] + shift, ring[(i + 1) % ring.size()] + shift};
        if (least_square(segment, limit) < limit) {
            return true;
        }
    }
    return overlaps_wholly(ring, shift);
}

double PlacedOutlines::distance(const Ring& ring, double limit_mm) const {
    double least = limit_mm * limit_mm;
    for (std::size_t i = 0; i < ring.size() && least > 0.0; ++i) {
        least = least_square({ring[i], ring[(i + 1) % ring.size()]}, least);
    }
    return overlaps_wholly(ring, Eigen::Vector2d::Zero()) ? 0.0 : std::sqrt(least);
}

}  // namespace leafcutter::fab
