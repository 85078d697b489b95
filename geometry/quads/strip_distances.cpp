#include "geometry/quads/strip_distances.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

#include <Eigen/Geometry>

#include "geometry/parallel.h"
#include "geometry/quads/half_sag.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Vector3d;

constexpr int kSamples = 7;  // Per side of a quad.
constexpr int kRowsAtOnce = 8;

// Lines of the grid round a range of strips and one strip more on either side, numbered for
// themselves.
class Band {
public:
    Band(const ChartGrid& grid, const StripRange& strips) : grid_(grid), strips_(strips) {
        const bool along = strips.axis == Axis::F;
        const bool closed = along ? grid.closed_along() : grid.closed_across();
        const int last = strips.first + strips.count;
        const int all = along ? grid.grid().rows : grid.grid().cols;
        low_ = closed ? strips.first - 1 : std::max(0, strips.first - 1);
        high_ = closed ? last + 1 : std::min(all, last + 1);
        cells_ = along ? grid.grid().cols : grid.grid().rows;
        const bool ring = along ? grid.closed_across() : grid.closed_along();
        points_ = cells_ + (ring ? 0 : 1);
    }

    std::vector<Vector3d> points(const ChartSampler& sampler) const {
        std::vector<Vector3d> points;
        for (int line = low_; line <= high_; ++line) {
            for (int k = 0; k < points_; ++k) {
                points.push_back(at(sampler, level(strips_.axis, line), level(other_axis(), k)));
            }
        }
        return points;
    }

    // Of all strips, those beside the range too.
    std::vector<SagCell> cells(const ChartSampler& sampler,
                               const std::vector<Vector3d>& points) const {
        std::vector<SagCell> cells;
        for (int line = low_; line < high_; ++line) {
            for (int k = 0; k < cells_; ++k) {
                const std::array<int, 4> corners = corners_of(line, k);
                const auto corner = [&](std::size_t i) -> const Vector3d& {
                    return points[static_cast<std::size_t>(corners[i])];
                };
                cells.push_back({.corners = corners,
                                 .surface_centre = at(sampler, middle(strips_.axis, line),
                                                      middle(other_axis(), k)),
                                 .surface_vector_area =
                                     0.5 * (corner(2) - corner(0)).cross(corner(3) - corner(1))});
            }
        }
        return cells;
    }

    std::size_t first_cell() const {
        return static_cast<std::size_t>(strips_.first - low_) * static_cast<std::size_t>(cells_);
    }
    std::size_t cell_count() const {
        return static_cast<std::size_t>(strips_.count) * static_cast<std::size_t>(cells_);
    }

private:
    Axis other_axis() const { return strips_.axis == Axis::F ? Axis::G : Axis::F; }
    double level(Axis axis, int line) const {
        return axis == Axis::F ? grid_.f_level(line) : grid_.s_level(line);
    }
    double middle(Axis axis, int line) const {
        return 0.5 * (level(axis, line) + level(axis, line + 1));
    }
    Vector3d at(const ChartSampler& sampler, double own, double other) const {
        return sampler.point(grid_.unstraight(
            strips_.axis == Axis::F ? Eigen::Vector2d(other, own) : Eigen::Vector2d(own, other)));
    }
    int point(int line, int k) const { return (line - low_) * points_ + k % points_; }
    // In the order of all quads: weft, then warp.
    std::array<int, 4> corners_of(int line, int k) const {
        if (strips_.axis == Axis::F) {
            return {point(line, k), point(line, k + 1), point(line + 1, k + 1), point(line + 1, k)};
        }
        return {point(line, k), point(line + 1, k), point(line + 1, k + 1), point(line, k + 1)};
    }

    const ChartGrid& grid_;
    StripRange strips_;
    int low_ = 0;  // Strips.
    int high_ = 0;
    int cells_ = 0;   // Of a strip.
    int points_ = 0;  // Of a line.
};

StripQuad measured(const std::vector<Vector3d>& points,
                   const std::array<int, 4>& corners,
                   const ClosestPoint& surface) {
    const auto corner = [&](std::size_t i) -> const Vector3d& {
        return points[static_cast<std::size_t>(corners[i])];
    };
    const Vector3d& a = corner(0);
    const Vector3d& b = corner(1);
    const Vector3d& c = corner(2);
    const Vector3d& d = corner(3);
    StripQuad quad{.weft_mm = 0.5 * ((b - a).norm() + (c - d).norm()),
                   .warp_mm = 0.5 * ((d - a).norm() + (c - b).norm())};
    int near = -1;
    for (int i = 0; i < kSamples; ++i) {
        const double v = static_cast<double>(i) / (kSamples - 1);
        for (int k = 0; k < kSamples; ++k) {
            // To and fro, so that each sample starts from the hit of a neighbour.
            const int j = i % 2 == 0 ? k : kSamples - 1 - k;
            const double u = static_cast<double>(j) / (kSamples - 1);
            const ClosestPoint::Hit hit =
                surface.query((1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * d + u * c), near);
            near = hit.triangle;
            quad.distance_mm = std::max(quad.distance_mm, hit.distance);
        }
    }
    return quad;
}

}  // namespace

double GridDistances::largest() const {
    return *std::max_element(percent.begin(), percent.end());
}

double GridDistances::mean() const {
    return std::accumulate(percent.begin(), percent.end(), 0.0) /
           static_cast<double>(percent.size());
}

GridDistances StripDistances::measure(const ChartGrid& grid, const Context& context) const {
    const int rows = grid.grid().rows;
    const auto cols = static_cast<std::size_t>(grid.grid().cols);
    std::vector<StripQuad> quads(static_cast<std::size_t>(rows) * cols);
    const auto tasks = static_cast<std::size_t>((rows + kRowsAtOnce - 1) / kRowsAtOnce);
    for_each_task(tasks, context, [&](std::size_t task, const Context&) {
        const int first = static_cast<int>(task) * kRowsAtOnce;
        const std::vector<StripQuad> part = measure(
            grid, {.axis = Axis::F, .first = first, .count = std::min(kRowsAtOnce, rows - first)});
        std::copy(
            part.begin(), part.end(),
            quads.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(first) * cols));
    });
    GridDistances found;
    found.row_mm.assign(static_cast<std::size_t>(rows), 0.0);
    found.col_mm.assign(cols, 0.0);
    for (std::size_t i = 0; i < quads.size(); ++i) {
        found.row_mm[i / cols] += quads[i].weft_mm;
        found.col_mm[i % cols] += quads[i].warp_mm;
    }
    for (std::size_t i = 0; i < quads.size(); ++i) {
        const double length = 0.5 * (found.row_mm[i / cols] + found.col_mm[i % cols]);
        found.percent.push_back(100.0 * quads[i].distance_mm / std::max(length, 1e-300));
    }
    return found;
}

std::vector<StripQuad> StripDistances::measure(const ChartGrid& grid,
                                               const StripRange& strips) const {
    const Band band(grid, strips);
    std::vector<Vector3d> points = band.points(sampler_);
    const std::vector<SagCell> cells = band.cells(sampler_, points);
    if (half_sag_offset_) {
        offset_by_half_sag(points, cells);
    }
    std::vector<StripQuad> quads;
    quads.reserve(band.cell_count());
    for (std::size_t i = 0; i < band.cell_count(); ++i) {
        quads.push_back(measured(points, cells[band.first_cell() + i].corners, surface_));
    }
    return quads;
}

}  // namespace leafcutter::geometry
