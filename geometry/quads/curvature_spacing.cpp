#include "geometry/quads/curvature_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/quads/grid.h"
#include "geometry/quads/spacing.h"

namespace leafcutter::geometry {

namespace {

using Eigen::Vector3d;

constexpr int kSamplesPerCell = 4;
// Second differences span a cell: the sag of a strip there is an eighth of them.
constexpr int kReach = kSamplesPerCell / 2;
// No width more than this times wider or narrower than even.
constexpr double kStrongest = 2.0;
// Second differences below this part of a cell are flat.
constexpr double kFlat = 1e-6;

// A mean of order `order` over each leaf, then to the power `exponent`. The sag of a strip grows
// with the square of its width: exponent 1/2 makes sags equal, 1/3 their mean smallest; order 1
// looks at the mean sag along a strip, 4 rather at the largest.
struct Rule {
    double order = 1.0;
    double exponent = 0.5;
};
constexpr std::array<Rule, 6> kRules{{{4.0, 0.5},
                                      {4.0, 1.0 / 3.0},
                                      {4.0, 1.0 / 6.0},
                                      {1.0, 0.5},
                                      {1.0, 1.0 / 3.0},
                                      {1.0, 1.0 / 6.0}}};

// Bending across the strips of one family at one sample of the surface.
struct Bending {
    double second_difference = 0.0;  // mm, along the normal.
    double area = 0.0;               // Of the sample's surroundings, mm².
};

std::vector<double> subdivided(const std::vector<double>& levels) {
    std::vector<double> fine;
    for (std::size_t i = 0; i + 1 < levels.size(); ++i) {
        for (int k = 0; k < kSamplesPerCell; ++k) {
            fine.push_back(levels[i] + (levels[i + 1] - levels[i]) * k / kSamplesPerCell);
        }
    }
    fine.push_back(levels.back());
    return fine;
}

CylinderGrid refined(const CylinderGrid& grid) {
    CylinderGrid fine = grid;
    fine.rows *= kSamplesPerCell;
    fine.cols *= kSamplesPerCell;
    fine.column_shift *= kSamplesPerCell;
    fine.f_levels = subdivided(grid.f_levels);
    fine.g_levels = subdivided(grid.g_levels);
    return fine;
}

class SampledChart {
public:
    SampledChart(const Cylinder& chart, const CylinderGrid& even, const ChartSampler& sampler)
        : grid_(chart, refined(even)) {
        for (int row = 0; row < grid_.vertex_rows(); ++row) {
            const int end = grid_.first_col(row) + grid_.vertices_in(row);
            for (int col = grid_.first_col(row); col < end; ++col) {
                points_.push_back(
                    sampler.point(grid_.unstraight({grid_.s_level(col), grid_.f_level(row)})));
            }
        }
    }

    int strips(Axis axis) const { return count(axis) / kSamplesPerCell; }
    bool closed(Axis axis) const {
        return axis == Axis::F ? grid_.closed_along() : grid_.closed_across();
    }

    // All samples of one strip between two levels of `axis`.
    std::vector<Bending> strip(Axis axis, int number) const {
        const Axis other = axis == Axis::F ? Axis::G : Axis::F;
        std::vector<Bending> samples;
        for (int i = number * kSamplesPerCell; i < (number + 1) * kSamplesPerCell; ++i) {
            for (int j = 0; j < count(other); ++j) {
                samples.push_back(axis == Axis::F ? bending(axis, i, j) : bending(axis, j, i));
            }
        }
        return samples;
    }

    double mean_step() const {
        double sum = 0.0;
        for (int row = 0; row < count(Axis::F); ++row) {
            sum += (point(row + 1, 0) - point(row, 0)).norm();
        }
        return sum / count(Axis::F);
    }

private:
    int count(Axis axis) const { return axis == Axis::F ? grid_.grid().rows : grid_.grid().cols; }
    const Vector3d& point(int row, int col) const {
        return points_[static_cast<std::size_t>(grid_.vertex(row, col))];
    }
    // At a boundary the nearest place where all of the difference lies on the surface.
    int inside(Axis axis, int index, int reach) const {
        return closed(axis) ? index : std::clamp(index, reach, count(axis) - reach);
    }

    Bending bending(Axis axis, int row, int col) const {
        const bool along = axis == Axis::F;
        row = inside(Axis::F, row, along ? kReach : 1);
        col = inside(Axis::G, col, along ? 1 : kReach);
        const Vector3d across = (point(row, col + 1) - point(row, col - 1))
                                    .cross(point(row + 1, col) - point(row - 1, col));
        const int up = along ? kReach : 0;
        const int on = along ? 0 : kReach;
        const Vector3d difference =
            point(row + up, col + on) - 2.0 * point(row, col) + point(row - up, col - on);
        const double area = across.norm();
        return {.second_difference = area > 0.0 ? std::abs(difference.dot(across)) / area : 0.0,
                .area = area};
    }

    ChartGrid grid_;
    std::vector<Vector3d> points_;
};

double leaf_mean(const std::vector<Bending>& samples, double order, Spacing spacing) {
    double sum = 0.0;
    double weights = 0.0;
    for (const Bending& sample : samples) {
        const double weight = spacing == Spacing::CurvatureArea ? sample.area : 1.0;
        sum += weight * std::pow(sample.second_difference, order);
        weights += weight;
    }
    return weights > 0.0 ? std::pow(sum / weights, 1.0 / order) : 0.0;
}

std::vector<double> smoothed(const std::vector<double>& values, bool closed) {
    const int count = static_cast<int>(values.size());
    const auto at = [&](int i) {
        const int place = closed ? (i + count) % count : std::clamp(i, 0, count - 1);
        return values[static_cast<std::size_t>(place)];
    };
    std::vector<double> result;
    result.reserve(values.size());
    for (int i = 0; i < count; ++i) {
        result.push_back(0.25 * at(i - 1) + 0.5 * at(i) + 0.25 * at(i + 1));
    }
    return result;
}

// How densely levels are to lie in each even strip, 1 on average or nearly so.
std::vector<double> densities(const SampledChart& chart,
                              Axis axis,
                              const Rule& rule,
                              Spacing spacing) {
    std::vector<double> means;
    means.reserve(static_cast<std::size_t>(chart.strips(axis)));
    for (int i = 0; i < chart.strips(axis); ++i) {
        means.push_back(leaf_mean(chart.strip(axis, i), rule.order, spacing));
    }
    std::vector<double> density = smoothed(means, chart.closed(axis));
    const double largest = *std::max_element(density.begin(), density.end());
    if (largest <= kFlat * kSamplesPerCell * chart.mean_step()) {
        return std::vector<double>(density.size(), 1.0);
    }
    double sum = 0.0;
    for (double& value : density) {
        value = std::pow(value, rule.exponent);
        sum += value;
    }
    const double mean = sum / static_cast<double>(density.size());
    for (double& value : density) {
        value = std::clamp(value / mean, 1.0 / kStrongest, kStrongest);
    }
    return density;
}

std::vector<double> regraded(const std::vector<double>& levels,
                             const std::vector<double>& density) {
    std::vector<double> cumulated{0.0};
    for (const double value : density) {
        cumulated.push_back(cumulated.back() + value);
    }
    std::vector<double> result{levels.front()};
    const std::size_t count = density.size();
    std::size_t at = 0;
    for (std::size_t i = 1; i < count; ++i) {
        const double wanted =
            cumulated.back() * static_cast<double>(i) / static_cast<double>(count);
        while (cumulated[at + 1] < wanted) {
            ++at;
        }
        const double part = (wanted - cumulated[at]) / density[at];
        result.push_back(levels[at] + part * (levels[at + 1] - levels[at]));
    }
    result.push_back(levels.back());
    return result;
}

}  // namespace

CurvatureLevels curvature_levels(const Cylinder& chart,
                                 const CylinderGrid& even,
                                 const ChartSampler& sampler,
                                 Spacing spacing) {
    const SampledChart sampled(chart, even, sampler);
    CurvatureLevels levels;
    for (const Rule& rule : kRules) {
        levels.rows.push_back(regraded(even.f_levels, densities(sampled, Axis::F, rule, spacing)));
        // Columns that are shifted into one another stay even.
        if (even.column_shift == 0) {
            levels.cols.push_back(
                regraded(even.g_levels, densities(sampled, Axis::G, rule, spacing)));
            if (chart.shape == ChartShape::Pillowcase) {
                levels.cols.back() = folded_levels(levels.cols.back());
            }
        }
    }
    return levels;
}

}  // namespace leafcutter::geometry
