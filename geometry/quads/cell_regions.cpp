#include "geometry/quads/cell_regions.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include <Eigen/Geometry>

#include "geometry/plane.h"

namespace leafcutter::geometry {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A convex piece of a triangle. Each corner knows its place in the grid and, for exact areas
// however small the triangle is in (g, f), its place in the triangle: both barycentric coordinates.
struct Corner {
    Vector2d place;
    Vector2d inside;
};

class Piece {
public:
    void add(const Corner& corner) { corners_[size_++] = corner; }
    std::size_t size() const { return size_; }
    const Corner& operator[](std::size_t i) const { return corners_[i]; }

    // Twice the area in barycentric coordinates: the part of the triangle that this piece is.
    double share() const {
        double sum = 0.0;
        for (std::size_t i = 2; i < size_; ++i) {
            const Vector2d u = corners_[i - 1].inside - corners_[0].inside;
            const Vector2d v = corners_[i].inside - corners_[0].inside;
            sum += turn_of(u, v);
        }
        return sum;
    }
    double low(Eigen::Index axis) const {
        double value = corners_[0].place[axis];
        for (std::size_t i = 1; i < size_; ++i) {
            value = std::min(value, corners_[i].place[axis]);
        }
        return value;
    }
    double high(Eigen::Index axis) const {
        double value = corners_[0].place[axis];
        for (std::size_t i = 1; i < size_; ++i) {
            value = std::max(value, corners_[i].place[axis]);
        }
        return value;
    }

private:
    // A triangle cut by the four sides of a cell, and one cut ahead: never more than 8 corners.
    std::array<Corner, 12> corners_;
    std::size_t size_ = 0;
};

struct Line {
    Eigen::Index axis = 0;
    double value = 0.0;
};

// Both parts get the same crossing points, so that no area is lost between them.
void split(const Piece& piece, const Line& line, Piece& below, Piece& above) {
    below = {};
    above = {};
    for (std::size_t i = 0; i < piece.size(); ++i) {
        const Corner& from = piece[i];
        const Corner& to = piece[(i + 1) % piece.size()];
        const double a = from.place[line.axis] - line.value;
        const double b = to.place[line.axis] - line.value;
        (a < 0.0 ? below : above).add(from);
        if ((a < 0.0) != (b < 0.0)) {
            const double t = a / (a - b);
            Corner crossing{.place = from.place + t * (to.place - from.place),
                            .inside = from.inside + t * (to.inside - from.inside)};
            crossing.place[line.axis] = line.value;
            below.add(crossing);
            above.add(crossing);
        }
    }
}

class RegionCutter {
public:
    RegionCutter(const ChartGrid& grid, CellRegions& regions) : grid_(grid), regions_(regions) {}

    void add(const std::array<Vector2d, 3>& corners, const Vector3d& vector_area) {
        vector_area_ = vector_area;
        area_ = vector_area.norm();
        Piece rest;
        rest.add({.place = corners[0], .inside = {0.0, 0.0}});
        rest.add({.place = corners[1], .inside = {1.0, 0.0}});
        rest.add({.place = corners[2], .inside = {0.0, 1.0}});
        const int last = grid_.row_at(rest.high(1));
        for (int row = grid_.row_at(rest.low(1)); row < last; ++row) {
            Piece below;
            Piece above;
            split(rest, {.axis = 1, .value = grid_.f_level(row + 1)}, below, above);
            add_row(below, row);
            rest = above;
        }
        add_row(rest, last);
    }

private:
    void add_row(Piece rest, int row) {
        if (rest.size() < 3) {
            return;
        }
        const int last = grid_.col_at(rest.high(0));
        for (int col = grid_.col_at(rest.low(0)); col < last; ++col) {
            Piece below;
            Piece above;
            split(rest, {.axis = 0, .value = grid_.s_level(col + 1)}, below, above);
            add_cell(below, row, col);
            rest = above;
        }
        add_cell(rest, row, last);
    }

    void add_cell(const Piece& piece, int row, int col) {
        if (piece.size() < 3) {
            return;
        }
        const auto cell = static_cast<std::size_t>(grid_.cell(row, col));
        const double share = piece.share();
        regions_.area[cell] += share * area_;
        regions_.vector_area[cell] += share * vector_area_;
    }

    const ChartGrid& grid_;
    CellRegions& regions_;
    Vector3d vector_area_ = Vector3d::Zero();
    double area_ = 0.0;
};

Vector3d vector_area(const TriangleMesh& mesh, std::size_t triangle) {
    const auto& corners = mesh.triangles[triangle];
    const Vector3d& a = mesh.positions[static_cast<std::size_t>(corners[0])];
    const Vector3d& b = mesh.positions[static_cast<std::size_t>(corners[1])];
    const Vector3d& c = mesh.positions[static_cast<std::size_t>(corners[2])];
    return 0.5 * (b - a).cross(c - a);
}

}  // namespace

CellRegions cut_regions(const Cylinder& chart, const ChartGrid& grid) {
    const auto cells =
        static_cast<std::size_t>(grid.grid().rows) * static_cast<std::size_t>(grid.grid().cols);
    CellRegions regions{.area = std::vector<double>(cells, 0.0),
                        .vector_area = std::vector<Vector3d>(cells, Vector3d::Zero())};
    RegionCutter cutter(grid, regions);
    for (std::size_t t = 0; t < chart.corner_gf.size(); ++t) {
        const auto& gf = chart.corner_gf[t];
        cutter.add({grid.straight(gf[0]), grid.straight(gf[1]), grid.straight(gf[2])},
                   vector_area(chart.mesh, t));
    }
    return regions;
}

}  // namespace leafcutter::geometry
