#include "geometry/quads/graded_grid.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "geometry/closest_point.h"
#include "geometry/quads/curvature_spacing.h"
#include "geometry/quads/strip_distances.h"

namespace leafcutter::geometry {
namespace {

// A grid counts by its largest distance, in that of the even one; each percent by which its mean
// distance is worse costs as much as so many of the largest.
constexpr double kWorseMean = 8.0;
constexpr double kMostWorse = 1.02;
// Rules for rows suit those for columns after so many rounds.
constexpr int kRounds = 2;

// Keeps the grid that comes closest.
class Closest {
public:
    Closest(const GradingWish& wish, const StripDistances& distances, const Context& context)
        : wish_(wish),
          distances_(distances),
          context_(context),
          even_(distances.measure(ChartGrid(wish.chart, wish.even), context)),
          best_(wish.even) {}

    const CylinderGrid& best() const { return best_; }

    void offer(const CylinderGrid& grid) {
        const GridDistances found = distances_.measure(ChartGrid(wish_.chart, grid), context_);
        const double largest = found.largest() / even_.largest();
        const double mean = found.mean() / even_.mean();
        const double cost = largest + kWorseMean * std::max(0.0, mean - 1.0);
        if (largest < 1.0 && mean <= kMostWorse && cost < least_) {
            least_ = cost;
            best_ = grid;
        }
    }

private:
    const GradingWish& wish_;
    const StripDistances& distances_;
    const Context& context_;
    GridDistances even_;
    CylinderGrid best_;
    double least_ = 1.0;
};

// Rules for rows and columns, each chosen beside the best of the other.
void offer_rules(const GradingWish& wish, Closest& closest) {
    const CurvatureLevels levels =
        curvature_levels(wish.chart, wish.even, wish.sampler, wish.spacing);
    for (std::size_t i = 0; i < levels.rows.size() && wish.movable.rows; ++i) {
        CylinderGrid both = wish.even;
        both.f_levels = levels.rows[i];
        if (wish.movable.cols && i < levels.cols.size()) {
            both.g_levels = levels.cols[i];
        }
        closest.offer(both);
    }
    for (int round = 0; round < kRounds; ++round) {
        for (const std::vector<double>& rows : levels.rows) {
            CylinderGrid grid = closest.best();
            grid.f_levels = rows;
            if (wish.movable.rows) {
                closest.offer(grid);
            }
        }
        for (const std::vector<double>& cols : levels.cols) {
            CylinderGrid grid = closest.best();
            grid.g_levels = cols;
            if (wish.movable.cols) {
                closest.offer(grid);
            }
        }
    }
}

}  // namespace

CylinderGrid graded_grid(const GradingWish& wish, const Context& context) {
    const ClosestPoint surface(wish.chart.mesh);
    const StripDistances distances(wish.sampler, surface, wish.half_sag_offset);
    Closest closest(wish, distances, context);
    offer_rules(wish, closest);
    if (wish.spacing == Spacing::CurvatureArea) {
        MovableLevels movable = wish.movable;
        // Columns that are shifted into one another, or folded onto one another, stay.
        movable.cols = movable.cols && wish.even.column_shift == 0 &&
                       wish.even.shape != ChartShape::Pillowcase;
        const CylinderGrid by_rule = closest.best();
        for (const CylinderGrid& start : {by_rule, wish.even}) {
            closest.offer(
                closest_levels(wish.chart, distances, {wish.even, start}, movable, context));
        }
    }
    return closest.best();
}

}  // namespace leafcutter::geometry
