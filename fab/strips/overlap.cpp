#include "fab/strips/overlap.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <polyclipping/clipper.hpp>

#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

namespace {

using Eigen::Vector2d;

struct GridPoint {
    std::int64_t x = 0;
    std::int64_t y = 0;
    bool operator==(const GridPoint&) const = default;
};

struct GridSegment {
    GridPoint from;
    GridPoint to;
};

GridPoint to_grid(const Vector2d& point) {
    return {std::llround(point.x() * kGridPerMm), std::llround(point.y() * kGridPerMm)};
}

// Sign of the turn a → b → c. Differences below 2^31 (21 m) keep the products below 2^62.
int turn(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    const std::int64_t one = (b.x - a.x) * (c.y - a.y);
    const std::int64_t two = (b.y - a.y) * (c.x - a.x);
    return one > two ? 1 : (one < two ? -1 : 0);
}

bool within_box(const GridSegment& segment, const GridPoint& point) {
    return std::min(segment.from.x, segment.to.x) <= point.x &&
           point.x <= std::max(segment.from.x, segment.to.x) &&
           std::min(segment.from.y, segment.to.y) <= point.y &&
           point.y <= std::max(segment.from.y, segment.to.y);
}

// True if the closed segments share a point.
bool touch(const GridSegment& a, const GridSegment& b) {
    const int one = turn(a.from, a.to, b.from);
    const int two = turn(a.from, a.to, b.to);
    const int three = turn(b.from, b.to, a.from);
    const int four = turn(b.from, b.to, a.to);
    if (one != two && three != four) {
        return true;
    }
    return (one == 0 && within_box(a, b.from)) || (two == 0 && within_box(a, b.to)) ||
           (three == 0 && within_box(b, a.from)) || (four == 0 && within_box(b, a.to));
}

// Two edges of a ring that follow each other may share their corner and nothing else.
bool fold_back(const GridSegment& first, const GridSegment& second) {
    if (turn(first.from, first.to, second.to) != 0) {
        return false;
    }
    const std::int64_t ahead = (first.to.x - first.from.x) * (second.to.x - second.from.x) +
                               (first.to.y - first.from.y) * (second.to.y - second.from.y);
    return ahead < 0;
}

using Cell = std::pair<int, int>;

double mean_edge(const Ring& ring) {
    double length = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        length += (ring[(i + 1) % ring.size()] - ring[i]).norm();
    }
    return std::max(length / static_cast<double>(ring.size()), 1e-3);
}

int cell_of(double coordinate, double cell_mm) {
    return static_cast<int>(std::floor(coordinate / cell_mm));
}

// Calls visit(cell) for every cell of the segment's bounding box, `pad_mm` around it, one step at a
// time along long ones.
template <typename Visit>
void for_cells(
    const Vector2d& from, const Vector2d& to, double cell_mm, Visit visit, double pad_mm = 0.0) {
    const int pieces = 1 + static_cast<int>((to - from).norm() / (4.0 * cell_mm));
    for (int i = 0; i < pieces; ++i) {
        // A hair of overlap, so that rounding never leaves a cell out.
        const double lo = (i - 1e-6) / pieces;
        const double hi = (i + 1 + 1e-6) / pieces;
        const Vector2d p = from + lo * (to - from);
        const Vector2d q = from + hi * (to - from);
        for (int x = cell_of(std::min(p.x(), q.x()) - pad_mm, cell_mm);
             x <= cell_of(std::max(p.x(), q.x()) + pad_mm, cell_mm); ++x) {
            for (int y = cell_of(std::min(p.y(), q.y()) - pad_mm, cell_mm);
                 y <= cell_of(std::max(p.y(), q.y()) + pad_mm, cell_mm); ++y) {
                visit(Cell{x, y});
            }
        }
    }
}

struct HashCell {
    std::size_t operator()(const Cell& cell) const {
        return static_cast<std::size_t>(cell.first) * 0x9E3779B97F4A7C15ULL ^
               static_cast<std::size_t>(cell.second) * 0xC2B2AE3D27D4EB4FULL;
    }
};

std::vector<GridPoint> on_grid(const Ring& ring) {
    std::vector<GridPoint> points;
    points.reserve(ring.size());
    for (const Vector2d& point : ring) {
        points.push_back(to_grid(point));
    }
    return points;
}

double squared_distance(const Vector2d& point, const Vector2d& from, const Vector2d& to) {
    const Vector2d along = to - from;
    const double length2 = along.squaredNorm();
    const double t =
        length2 > 0.0 ? std::clamp((point - from).dot(along) / length2, 0.0, 1.0) : 0.0;
    return (from + t * along - point).squaredNorm();
}

// True if no two edges of a simple ring come closer but those that share a corner, or are joined by
// an edge like the two sides of a step.
bool keeps_clear(const Ring& ring, double distance_mm) {
    const std::size_t n = ring.size();
    const double cell_mm = std::max(mean_edge(ring), distance_mm);
    std::unordered_map<Cell, std::vector<std::size_t>, HashCell> grid;
    grid.reserve(2 * n);
    bool clear = true;
    const auto apart = [&](std::size_t i, std::size_t j) {
        const Vector2d &p = ring[i], &q = ring[(i + 1) % n];
        const Vector2d &r = ring[j], &s = ring[(j + 1) % n];
        return std::min({squared_distance(p, r, s), squared_distance(q, r, s),
                         squared_distance(r, p, q), squared_distance(s, p, q)}) >
               distance_mm * distance_mm;
    };
    const auto is_step = [&](std::size_t i, std::size_t j) {
        const Vector2d one = ring[(i + 1) % n] - ring[i];
        const Vector2d other = ring[(j + 1) % n] - ring[j];
        return ((i + 2) % n == j || (j + 2) % n == i) && one.dot(other) > 0.0;
    };
    for (std::size_t i = 0; i < n && clear; ++i) {
        const auto visit = [&](const Cell& cell) {
            std::vector<std::size_t>& others = grid[cell];
            for (const std::size_t other : others) {
                const bool neighbours = other == i || (other + 1) % n == i || (i + 1) % n == other;
                clear = clear && (neighbours || apart(i, other) || is_step(i, other));
            }
            if (others.empty() || others.back() != i) {
                others.push_back(i);
            }
        };
        for_cells(ring[i], ring[(i + 1) % n], cell_mm, visit, distance_mm / 2.0);
    }
    return clear;
}

bool neighbours_ok(const std::vector<GridPoint>& points) {
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i) {
        const GridSegment first{points[i], points[(i + 1) % n]};
        const GridSegment second{points[(i + 1) % n], points[(i + 2) % n]};
        if (fold_back(first, second)) {
            return false;
        }
    }
    return true;
}

}  // namespace

Ring snapped(const Ring& ring) {
    Ring result;
    GridPoint last;
    for (const Vector2d& point : ring) {
        const GridPoint grid = to_grid(point);
        if (result.empty() || !(grid == last)) {
            result.emplace_back(static_cast<double>(grid.x) / kGridPerMm,
                                static_cast<double>(grid.y) / kGridPerMm);
            last = grid;
        }
    }
    while (result.size() > 1 && to_grid(result.front()) == to_grid(result.back())) {
        result.pop_back();
    }
    return result.size() < 3 ? Ring{} : result;
}

bool is_simple(const Ring& ring) {
    const std::size_t n = ring.size();
    if (n < 3 || signed_area(ring) <= 0.0) {
        return false;
    }
    const std::vector<GridPoint> points = on_grid(ring);
    if (!neighbours_ok(points)) {
        return false;
    }
    const auto segment = [&](std::size_t i) { return GridSegment{points[i], points[(i + 1) % n]}; };
    const double cell_mm = mean_edge(ring);
    std::unordered_map<Cell, std::vector<std::size_t>, HashCell> grid;
    bool simple = true;
    for (std::size_t i = 0; i < n && simple; ++i) {
        for_cells(ring[i], ring[(i + 1) % n], cell_mm, [&](const Cell& cell) {
            std::vector<std::size_t>& others = grid[cell];
            for (const std::size_t other : others) {
                const bool neighbours = other == i || (other + 1) % n == i || (i + 1) % n == other;
                simple = simple && (neighbours || !touch(segment(i), segment(other)));
            }
            if (others.empty() || others.back() != i) {
                others.push_back(i);
            }
        });
    }
    return simple;
}

bool keeps_gap(const Ring& ring, double gap_mm) {
    // Grown corners reach as far as the mitre, twice as far as sides.
    if (keeps_clear(ring, 2.0 * gap_mm)) {
        return true;
    }
    ClipperLib::Path path;
    for (const Vector2d& point : ring) {
        const GridPoint grid = to_grid(point);
        path.emplace_back(grid.x, grid.y);
    }
    ClipperLib::ClipperOffset offset;
    offset.AddPath(path, ClipperLib::jtMiter, ClipperLib::etClosedPolygon);
    ClipperLib::Paths grown;
    offset.Execute(grown, gap_mm / 2.0 * kGridPerMm);
    return grown.size() == 1;
}

std::size_t RingInterior::CellHash::operator()(const Cell& cell) const {
    return HashCell()(cell);
}

RingInterior::RingInterior(const Ring& ring) : ring_(ring), cell_mm_(mean_edge(ring)) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
        for_cells(ring[i], ring[(i + 1) % ring.size()], cell_mm_, [&](const Cell& cell) {
            std::vector<int>& edges = edges_[cell];
            if (edges.empty() || edges.back() != static_cast<int>(i)) {
                edges.push_back(static_cast<int>(i));
            }
        });
    }
}

bool RingInterior::inside(const Vector2d& point) const {
    bool result = false;
    const GridPoint p = to_grid(point);
    for (std::size_t i = 0; i < ring_.size(); ++i) {
        const GridPoint a = to_grid(ring_[i]);
        const GridPoint b = to_grid(ring_[(i + 1) % ring_.size()]);
        if ((a.y > p.y) != (b.y > p.y)) {
            const bool upward = b.y > a.y;
            result ^= (turn(a, b, p) > 0) == upward;
        }
    }
    return result;
}

bool RingInterior::contains(const Polyline& line) const {
    if (line.empty() || !inside(line.front())) {
        return false;
    }
    const std::size_t n = ring_.size();
    bool clear = true;
    for (std::size_t i = 0; i + 1 < line.size() && clear; ++i) {
        const GridSegment segment{to_grid(line[i]), to_grid(line[i + 1])};
        for_cells(line[i], line[i + 1], cell_mm_, [&](const Cell& cell) {
            const auto found = edges_.find(cell);
            if (found == edges_.end()) {
                return;
            }
            for (const int edge : found->second) {
                const auto from = static_cast<std::size_t>(edge);
                const GridSegment side{to_grid(ring_[from]), to_grid(ring_[(from + 1) % n])};
                clear = clear && !touch(segment, side);
            }
        });
    }
    return clear;
}

}  // namespace leafcutter::fab
