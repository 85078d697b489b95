#include "geometry/leaves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "geometry/half_edges.h"
#include "geometry/quads/grid.h"
#include "geometry/quads/spacing.h"

namespace leafcutter::geometry {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A value this close to the ends of the chart, of its length, is on its boundary.
constexpr double kOnBoundary = 1e-12;

// Traces all leaves of one family through the triangles of a chart.
//
// Whether a level passes a vertex to the one side or the other is decided once per vertex, as a
// whole number: the rank, the number of the first level that is not below the vertex. Corners
// lifted by periods get that rank plus whole periods. So all triangles agree, whatever the
// rounding: a level crosses no or two sides of a triangle, and each leaf is one curve.
class LeafTracer {
public:
    LeafTracer(const Cylinder& chart, const ChartGrid& grid, Axis axis)
        : chart_(chart),
          grid_(grid),
          axis_(axis),
          half_edges_(build_half_edges(chart.mesh.triangles,
                                       static_cast<int>(chart.mesh.positions.size()))) {
        rank_corners();
        starts_.push_back(0);
        for (std::size_t t = 0; t < chart_.mesh.triangles.size(); ++t) {
            const auto [low, high] = rank_range(t);
            starts_.push_back(starts_.back() + static_cast<std::size_t>(high - low));
        }
        passed_.assign(starts_.back(), false);
    }

    std::vector<Leaf> trace_all() {
        std::vector<Leaf> leaves;
        for (std::size_t t = 0; t < chart_.mesh.triangles.size(); ++t) {
            const auto [low, high] = rank_range(t);
            for (int level = low; level < high; ++level) {
                if (!passed_[segment(t, level)]) {
                    leaves.push_back(trace({.triangle = t, .level = level}));
                }
            }
        }
        std::stable_sort(leaves.begin(), leaves.end(),
                         [](const Leaf& a, const Leaf& b) { return a.level < b.level; });
        return leaves;
    }

private:
    struct Place {
        std::size_t triangle = 0;
        int level = 0;  // Lifted as the corners of this triangle are.
    };

    double value(const Vector2d& gf) const {
        const Vector2d straight = grid_.straight(gf);
        return axis_ == Axis::F ? straight.y() : straight.x();
    }
    double level_value(int level) const {
        return axis_ == Axis::F ? grid_.f_level(level) : grid_.s_level(level);
    }
    int level_count() const { return axis_ == Axis::F ? grid_.grid().rows : grid_.grid().cols; }
    bool closes() const { return axis_ == Axis::F ? grid_.closed_along() : grid_.closed_across(); }

    int rank_of(double value) const {
        if (!closes()) {
            const double length = level_value(level_count());
            if (value <= kOnBoundary * length) {
                return 0;
            }
            // Beyond the last level, so that it is a leaf too.
            if (value >= (1.0 - kOnBoundary) * length) {
                return level_count() + 1;
            }
        }
        const int below = axis_ == Axis::F ? grid_.row_at(value) : grid_.col_at(value);
        return level_value(below) < value ? below + 1 : below;
    }

    // How many levels the whole periods from `home` to `away` are.
    int levels_between(const Vector2d& home, const Vector2d& away) const {
        if (chart_.shape == ChartShape::Rectangle) {
            return 0;
        }
        const Vector2d apart = away - home;
        const bool torus = chart_.shape == ChartShape::Torus;
        const double turns = torus ? std::round(apart.y() / chart_.height) : 0.0;
        const double rounds = std::round((apart.x() - turns * chart_.shear) / chart_.width);
        const double levels = axis_ == Axis::F
                                  ? turns * grid_.grid().rows
                                  : rounds * grid_.grid().cols + turns * grid_.grid().column_shift;
        return static_cast<int>(levels);
    }

    void rank_corners() {
        struct Home {
            Vector2d gf;
            int rank;
        };
        std::vector<std::optional<Home>> homes(chart_.mesh.positions.size());
        for (std::size_t t = 0; t < chart_.mesh.triangles.size(); ++t) {
            std::array<int, 3> ranks{};
            for (std::size_t k = 0; k < 3; ++k) {
                const Vector2d& gf = chart_.corner_gf[t][k];
                auto& home = homes[static_cast<std::size_t>(chart_.mesh.triangles[t][k])];
                if (!home) {
                    home = Home{.gf = gf, .rank = rank_of(value(gf))};
                }
                ranks[k] = home->rank + levels_between(home->gf, gf);
            }
            ranks_.push_back(ranks);
        }
    }

    std::pair<int, int> rank_range(std::size_t t) const {
        const auto [low, high] = std::minmax_element(ranks_[t].begin(), ranks_[t].end());
        return {*low, *high};
    }

    std::size_t segment(std::size_t t, int level) const {
        return starts_[t] + static_cast<std::size_t>(level - rank_range(t).first);
    }

    bool crosses(std::size_t t, std::size_t side, int level) const {
        const int from = ranks_[t][side];
        const int to = ranks_[t][(side + 1) % 3];
        return std::min(from, to) <= level && level < std::max(from, to);
    }

    Vector3d crossing(const Place& at, std::size_t side) const {
        const auto& corners = chart_.mesh.triangles[at.triangle];
        const std::size_t next = (side + 1) % 3;
        const double from = value(chart_.corner_gf[at.triangle][side]);
        const double to = value(chart_.corner_gf[at.triangle][next]);
        const double part = std::clamp((level_value(at.level) - from) / (to - from), 0.0, 1.0);
        const Vector3d& a = chart_.mesh.positions[static_cast<std::size_t>(corners[side])];
        const Vector3d& b = chart_.mesh.positions[static_cast<std::size_t>(corners[next])];
        return a + part * (b - a);
    }

    // The sides that the level crosses: first the one where it comes in with rising ranks.
    std::array<std::size_t, 2> crossed_sides(const Place& at) const {
        std::array<std::size_t, 2> sides{};
        for (std::size_t side = 0; side < 3; ++side) {
            if (crosses(at.triangle, side, at.level)) {
                const bool rising = ranks_[at.triangle][side] < ranks_[at.triangle][(side + 1) % 3];
                sides[rising ? 0 : 1] = side;
            }
        }
        return sides;
    }

    // Walks out of `at` and on until the boundary or back to `at`; true for the latter. `way` is
    // the index of the side to leave through among crossed_sides(), the same all along.
    bool walk(const Place& start, std::size_t way, std::vector<Vector3d>& points) {
        Place at = start;
        while (true) {
            const std::size_t side = crossed_sides(at)[way];
            points.push_back(crossing(at, side));
            const int here = static_cast<int>(3 * at.triangle + side);
            const int twin = half_edges_.twin_of(here);
            if (twin < 0) {
                return false;
            }
            const auto next = static_cast<std::size_t>(twin) / 3;
            const auto twin_side = static_cast<std::size_t>(twin) % 3;
            // The twin's corners are the same vertices, the other way round and maybe lifted.
            const int lift = ranks_[next][(twin_side + 1) % 3] - ranks_[at.triangle][side];
            at = {.triangle = next, .level = at.level + lift};
            const std::size_t passed = segment(at.triangle, at.level);
            if (passed_[passed]) {
                return true;
            }
            passed_[passed] = true;
        }
    }

    // The number of the level within the grid, and so of the leaf, at one of its places.
    int base_level(const Place& at) const {
        int level = at.level;
        if (!closes()) {
            return level;
        }
        if (axis_ == Axis::G && grid_.closed_along()) {
            const double f = chart_.corner_gf[at.triangle][0].y();
            level -= static_cast<int>(std::floor(f / chart_.height)) * grid_.grid().column_shift;
        }
        const int rest = level % level_count();
        return rest < 0 ? rest + level_count() : rest;
    }

    Leaf trace(const Place& start) {
        passed_[segment(start.triangle, start.level)] = true;
        Leaf leaf;
        leaf.of_conjugate = axis_ == Axis::G;
        leaf.level = level_value(base_level(start));
        leaf.closed = walk(start, 1, leaf.points);
        if (!leaf.closed) {
            std::vector<Vector3d> before;
            walk(start, 0, before);
            leaf.points.insert(leaf.points.begin(), before.rbegin(), before.rend());
        }
        // Levels through vertices cross all sides there at the same point.
        leaf.points.erase(std::unique(leaf.points.begin(), leaf.points.end()), leaf.points.end());
        if (leaf.closed && leaf.points.size() > 1 && leaf.points.front() == leaf.points.back()) {
            leaf.points.pop_back();
        }
        return leaf;
    }

    const Cylinder& chart_;
    const ChartGrid& grid_;
    Axis axis_;
    HalfEdges half_edges_;
    std::vector<std::array<int, 3>> ranks_;  // Per triangle and corner.
    std::vector<std::size_t> starts_;        // Per triangle the first of its segments.
    std::vector<bool> passed_;               // Per segment: one level in one triangle.
};

// Leaves of F* on a pillowcase go on over its folds, there and back, until they are closed or come
// to a singular point. `columns` has one leaf for each column of the grid, upwards.
class FoldedLeaves {
public:
    FoldedLeaves(std::vector<Leaf> columns, const CylinderGrid& grid)
        : columns_(std::move(columns)),
          count_(grid.cols),
          shift_(grid.column_shift),
          joined_(columns_.size(), false) {}

    std::vector<Leaf> join() {
        std::vector<Leaf> leaves;
        // From singular point to singular point: of the lower fold first, then of the upper.
        for (const bool up : {true, false}) {
            for (const int begin : {up ? 0 : shift_, (up ? 0 : shift_) + count_ / 2}) {
                const int column = wrapped(begin);
                if (!joined_[static_cast<std::size_t>(column)]) {
                    leaves.push_back(joined_from(column, up));
                }
            }
        }
        for (int column = 0; column < count_; ++column) {
            if (!joined_[static_cast<std::size_t>(column)]) {
                leaves.push_back(joined_from(column, true));
            }
        }
        std::stable_sort(leaves.begin(), leaves.end(),
                         [](const Leaf& a, const Leaf& b) { return a.level < b.level; });
        return leaves;
    }

private:
    int wrapped(int column) const { return ((column % count_) + count_) % count_; }

    Leaf joined_from(int begin, bool up) {
        Leaf leaf = columns_[static_cast<std::size_t>(begin)];
        leaf.points.clear();
        int column = begin;
        while (true) {
            joined_[static_cast<std::size_t>(column)] = true;
            const std::vector<Vector3d>& points = columns_[static_cast<std::size_t>(column)].points;
            leaf.level = std::min(leaf.level, columns_[static_cast<std::size_t>(column)].level);
            // Its first point lies on the fold, where the last one was.
            const std::ptrdiff_t skip = leaf.points.empty() ? 0 : 1;
            if (up) {
                leaf.points.insert(leaf.points.end(), points.begin() + skip, points.end());
            } else {
                leaf.points.insert(leaf.points.end(), points.rbegin() + skip, points.rend());
            }
            const int next = wrapped((up ? 2 * shift_ : 0) - column);
            if (next == column) {
                return leaf;  // At a singular point.
            }
            up = !up;
            column = next;
            if (joined_[static_cast<std::size_t>(column)]) {
                leaf.closed = true;
                leaf.points.pop_back();  // Where it began.
                return leaf;
            }
        }
    }

    std::vector<Leaf> columns_;
    int count_;
    int shift_;
    std::vector<bool> joined_;
};

// Leaves of F that lie on the folds are the critical arcs, not rings.
void replace_folds(std::vector<Leaf>& leaves, const Foliation& foliation, double height) {
    for (Leaf& leaf : leaves) {
        const bool upper = leaf.level >= height;
        if ((upper || leaf.level <= 0.0) && foliation.critical_graph.size() == 2) {
            leaf.closed = false;
            leaf.points = foliation.critical_graph[upper ? 1 : 0];
        }
    }
}

}  // namespace

std::vector<Leaf> sample_leaves(const Foliation& foliation, const QuadMesh& quads, int stride) {
    std::vector<Leaf> kept;
    const auto every = static_cast<std::size_t>(std::max(stride, 1));
    for (std::size_t i = 0; i < foliation.cylinders.size(); ++i) {
        if (quads.grids[i].rows == 0) {
            continue;  // Left out.
        }
        const Cylinder& chart = foliation.cylinders[i];
        const ChartGrid grid(chart, quads.grids[i]);
        for (const Axis axis : {Axis::F, Axis::G}) {
            std::vector<Leaf> leaves = LeafTracer(chart, grid, axis).trace_all();
            if (grid.has_folds() && axis == Axis::G) {
                leaves = FoldedLeaves(std::move(leaves), quads.grids[i]).join();
            } else if (grid.has_folds()) {
                replace_folds(leaves, foliation, chart.height);
            }
            for (std::size_t k = 0; k < leaves.size(); k += every) {
                leaves[k].cylinder = static_cast<int>(i);
                kept.push_back(std::move(leaves[k]));
            }
        }
    }
    return kept;
}

}  // namespace leafcutter::geometry
