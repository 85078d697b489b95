#include "geometry/quads/level_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/parallel.h"

namespace leafcutter::geometry {
namespace {

// The largest distance is looked at as a power mean of this order, so that the next ones count too.
constexpr double kOrder = 16.0;
// What a mean distance above that of even levels costs, and one below wins, against the largest.
constexpr double kWorseMean = 8.0;
constexpr double kBetterMean = 0.2;
// Only levels beside a quad this far off, of the largest distance, are moved.
constexpr double kFar = 0.6;
// A strip's width, of what it is in even levels.
constexpr double kNarrowest = 0.4;
constexpr double kWidest = 2.5;
// Of a strip's width: the first and the last steps of levels.
constexpr double kFirstStep = 0.24;
constexpr double kLastStep = 0.03;
constexpr int kMostSweeps = 12;
// Of the cost: less is rounding, and no reason to move anything.
constexpr double kLeastGain = 1e-5;
constexpr double kFlat = 1e-11;  // Of the leaves' lengths.
// Quads measured, at most: some seconds.
constexpr double kMostMeasured = 2.5e5;
// Levels so many apart don't see each other.
constexpr int kApart = 4;
constexpr int kReach = 2;  // Strips on either side that a level moves.

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

struct Sums {
    double power = 0.0;
    double plain = 0.0;

    void add(double distance, double sign) {
        power += sign * std::pow(distance, kOrder);
        plain += sign * distance;
    }
};

// A level's new place, and what the strips round it are then.
struct Move {
    double level = 0.0;
    StripRange strips;
    std::vector<double> distances;
    Sums change;
};

class LevelSearch {
public:
    LevelSearch(const Cylinder& chart,
                const StripDistances& distances,
                const CylinderGrid& even,
                const Context& context)
        : chart_(chart), distances_(distances), even_(even), grid_(even) {
        const GridDistances found = distances_.measure(ChartGrid(chart_, even_), context);
        unit_ = found.largest() / 100.0;
        even_mean_ = found.mean() / 100.0 / unit_;
    }

    // Nothing to do on a surface that the quads follow exactly.
    bool flat() const { return !(unit_ > kFlat); }

    const CylinderGrid& grid() const { return grid_; }

    void run(const CylinderGrid& start, MovableLevels movable, const Context& context) {
        grid_ = start;
        measure_all(context);
        double step = kFirstStep;
        for (int sweep = 0; sweep < kMostSweeps && step >= kLastStep; ++sweep) {
            const double before = cost();
            std::size_t moved = 0;
            if (movable.rows) {
                moved += sweep_levels(Axis::F, step, context);
            }
            if (movable.cols) {
                moved += sweep_levels(Axis::G, step, context);
            }
            measure_all(context);
            // A few last levels that go to and fro are not worth a sweep.
            if (moved < 4 || cost() > 0.97 * before) {
                step *= 0.5;
            }
            if (measured_ > kMostMeasured) {
                break;
            }
        }
    }

private:
    int count(Axis axis) const { return axis == Axis::F ? even_.rows : even_.cols; }
    int across(Axis axis) const { return count(axis == Axis::F ? Axis::G : Axis::F); }
    std::vector<double>& levels(Axis axis) {
        return axis == Axis::F ? grid_.f_levels : grid_.g_levels;
    }
    const std::vector<double>& even_levels(Axis axis) const {
        return axis == Axis::F ? even_.f_levels : even_.g_levels;
    }
    std::size_t cell(Axis axis, int strip, int k) const {
        const int rows = count(Axis::F);
        const int cols = count(Axis::G);
        const int own = (strip % count(axis) + count(axis)) % count(axis);
        return axis == Axis::F ? at(own) * at(cols) + at(k % cols)
                               : at(k % rows) * at(cols) + at(own);
    }

    double cost_of(const Sums& sums) const {
        const double cells = static_cast<double>(table_.size());
        const double change = sums.plain / cells / even_mean_ - 1.0;
        return std::pow(std::max(sums.power, 0.0), 1.0 / kOrder) +
               (change > 0.0 ? kWorseMean : kBetterMean) * change;
    }
    double cost() const { return cost_of(sums_); }
    double largest() const { return *std::max_element(table_.begin(), table_.end()); }

    // Distances of all quads over the lengths of their leaves, in units of the largest of even
    // ones.
    void measure_all(const Context& context) {
        found_ = distances_.measure(ChartGrid(chart_, grid_), context);
        measured_ += static_cast<double>(found_.percent.size());
        table_ = found_.percent;
        sums_ = {};
        for (double& distance : table_) {
            distance /= 100.0 * unit_;
            sums_.add(distance, 1.0);
        }
    }
    double relative(const StripQuad& quad, std::size_t cell) const {
        const std::size_t cols = at(count(Axis::G));
        const double length = 0.5 * (found_.row_mm[cell / cols] + found_.col_mm[cell % cols]);
        return quad.distance_mm / std::max(length, 1e-300) / unit_;
    }

    bool is_closed(Axis axis) const {
        return axis == Axis::F ? even_.shape == ChartShape::Torus
                               : even_.shape != ChartShape::Rectangle;
    }

    // Levels that may move at once. Where the axis is a circle its last ones also see the first.
    std::vector<std::vector<int>> groups(Axis axis) const {
        std::vector<std::vector<int>> groups(kApart);
        const int end = count(axis);
        for (int line = 1; line < end; ++line) {
            if (is_closed(axis) && line > end - kApart) {
                groups.push_back({line});
            } else {
                groups[at(line % kApart)].push_back(line);
            }
        }
        return groups;
    }

    std::size_t sweep_levels(Axis axis, double step, const Context& context) {
        std::size_t moved = 0;
        for (const std::vector<int>& group : groups(axis)) {
            std::vector<std::optional<Move>> moves(group.size());
            std::vector<double> tried(group.size(), 0.0);
            const double far = kFar * largest();
            for_each_task(group.size(), context, [&](std::size_t i, const Context&) {
                if (farthest_beside(axis, group[i]) >= far) {
                    moves[i] = best_move(axis, group[i], step);
                    tried[i] = 2.0 * (2 * kReach) * across(axis);
                }
            });
            for (std::size_t i = 0; i < group.size(); ++i) {
                measured_ += tried[i];
                if (moves[i]) {
                    accept(axis, group[i], *moves[i]);
                    ++moved;
                }
            }
        }
        return moved;
    }

    double farthest_beside(Axis axis, int line) const {
        double farthest = 0.0;
        for (int k = 0; k < across(axis); ++k) {
            farthest =
                std::max({farthest, table_[cell(axis, line - 1, k)], table_[cell(axis, line, k)]});
        }
        return farthest;
    }

    std::optional<Move> best_move(Axis axis, int line, double step) const {
        std::optional<Move> best;
        double least = cost() - kLeastGain;
        for (const double direction : {1.0, -1.0}) {
            const std::vector<double>& own = axis == Axis::F ? grid_.f_levels : grid_.g_levels;
            const double here = own[at(line)];
            const double room =
                direction > 0.0 ? own[at(line + 1)] - here : here - own[at(line - 1)];
            const double level = here + direction * step * room;
            if (!is_wide_enough(axis, own[at(line - 1)], level) ||
                !is_wide_enough(axis, level, own[at(line + 1)])) {
                continue;
            }
            Move move = try_move(axis, line, level);
            const double found = cost_of({.power = sums_.power + move.change.power,
                                          .plain = sums_.plain + move.change.plain});
            if (found < least) {
                least = found;
                best = std::move(move);
            }
        }
        return best;
    }

    // In strips of the even levels.
    double even_place(Axis axis, double level) const {
        const std::vector<double>& even = even_levels(axis);
        const auto above = std::upper_bound(even.begin() + 1, even.end() - 1, level);
        const auto below = above - 1;
        return static_cast<double>(below - even.begin()) + (level - *below) / (*above - *below);
    }
    bool is_wide_enough(Axis axis, double from, double to) const {
        const double width = even_place(axis, to) - even_place(axis, from);
        return width >= kNarrowest && width <= kWidest;
    }

    Move try_move(Axis axis, int line, double level) const {
        CylinderGrid trial = grid_;
        (axis == Axis::F ? trial.f_levels : trial.g_levels)[at(line)] = level;
        Move move{.level = level, .strips = {.axis = axis}, .distances = {}, .change = {}};
        move.strips.first = line - kReach;
        int last = line + kReach;
        if (!is_closed(axis)) {
            move.strips.first = std::max(0, move.strips.first);
            last = std::min(count(axis), last);
        }
        move.strips.count = std::min(last - move.strips.first, count(axis));
        const std::vector<StripQuad> quads =
            distances_.measure(ChartGrid(chart_, std::move(trial)), move.strips);
        for (std::size_t i = 0; i < quads.size(); ++i) {
            const int strip = move.strips.first + static_cast<int>(i) / across(axis);
            const std::size_t place = cell(axis, strip, static_cast<int>(i) % across(axis));
            move.distances.push_back(relative(quads[i], place));
            move.change.add(table_[place], -1.0);
            move.change.add(move.distances.back(), 1.0);
        }
        return move;
    }

    void accept(Axis axis, int line, const Move& move) {
        levels(axis)[at(line)] = move.level;
        sums_.power += move.change.power;
        sums_.plain += move.change.plain;
        for (std::size_t i = 0; i < move.distances.size(); ++i) {
            const int strip = move.strips.first + static_cast<int>(i) / across(axis);
            table_[cell(axis, strip, static_cast<int>(i) % across(axis))] = move.distances[i];
        }
    }

    const Cylinder& chart_;
    const StripDistances& distances_;
    CylinderGrid even_;
    CylinderGrid grid_;
    std::vector<double> table_;  // Per quad, by row and column.
    GridDistances found_;        // When all were last measured.
    Sums sums_;
    double unit_ = 1.0;
    double even_mean_ = 1.0;
    double measured_ = 0.0;
};

}  // namespace

CylinderGrid closest_levels(const Cylinder& chart,
                            const StripDistances& distances,
                            const SearchStart& from,
                            MovableLevels movable,
                            const Context& context) {
    LevelSearch search(chart, distances, from.even, context);
    if (search.flat()) {
        return from.even;
    }
    search.run(from.start, movable, context);
    return search.grid();
}

}  // namespace leafcutter::geometry
