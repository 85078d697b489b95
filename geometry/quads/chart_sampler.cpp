#include "geometry/quads/chart_sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/plane.h"

namespace leafcutter::geometry {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Smallest barycentric coordinate with which a point still counts as inside: rounding only.
constexpr double kInside = -1e-9;

struct Range {
    Vector2d low;
    Vector2d high;
};

Range range_of(const std::array<Vector2d, 3>& corners) {
    return {.low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]),
            .high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2])};
}

Vector3d barycentric(const std::array<Vector2d, 3>& t, const Vector2d& p) {
    const double area = turn_of(t[1] - t[0], t[2] - t[0]);
    const double a = turn_of(t[2] - t[1], p - t[1]) / area;
    const double b = turn_of(t[0] - t[2], p - t[2]) / area;
    const double c = turn_of(t[1] - t[0], p - t[0]) / area;
    return {a, b, c};
}

}  // namespace

ChartSampler::ChartSampler(const Cylinder& chart) : chart_(chart) {
    const double count = static_cast<double>(chart.corner_gf.size());
    const double side = std::sqrt(chart.width * chart.height / std::max(count, 1.0));
    const auto bins_along = [side](double length) {
        return static_cast<int>(std::clamp(std::ceil(length / side), 1.0, 4096.0));
    };
    columns_ = bins_along(chart.width);
    rows_ = bins_along(chart.height);

    const auto for_each_entry = [this](auto&& action) {
        for (int t = 0; t < static_cast<int>(chart_.corner_gf.size()); ++t) {
            const Range range = range_of(chart_.corner_gf[static_cast<std::size_t>(t)]);
            for (const Copy& copy : copies_of(t)) {
                const int last_row = bin_row(range.high.y() + copy.shift.y());
                const int last_column = bin_column(range.high.x() + copy.shift.x());
                for (int row = bin_row(range.low.y() + copy.shift.y()); row <= last_row; ++row) {
                    for (int column = bin_column(range.low.x() + copy.shift.x());
                         column <= last_column; ++column) {
                        action(bin(column, row), copy);
                    }
                }
            }
        }
    };
    bin_starts_.assign(bin(0, rows_) + 1, 0);
    for_each_entry([this](std::size_t at, const Copy&) { ++bin_starts_[at + 1]; });
    for (std::size_t i = 1; i < bin_starts_.size(); ++i) {
        bin_starts_[i] += bin_starts_[i - 1];
    }
    entries_.resize(bin_starts_.back());
    std::vector<std::size_t> next(bin_starts_.begin(), bin_starts_.end() - 1);
    for_each_entry([&](std::size_t at, const Copy& copy) { entries_[next[at]++] = copy; });
}

std::size_t ChartSampler::bin(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
}

int ChartSampler::bin_column(double g) const {
    const double place = g / chart_.width * columns_;
    return static_cast<int>(std::clamp(std::floor(place), 0.0, columns_ - 1.0));
}

int ChartSampler::bin_row(double f) const {
    const double place = f / chart_.height * rows_;
    return static_cast<int>(std::clamp(std::floor(place), 0.0, rows_ - 1.0));
}

// Into the fundamental domain [0, width] x [0, height].
Vector2d ChartSampler::reduced(Vector2d gf) const {
    if (chart_.shape == ChartShape::Torus) {
        const double turns = std::floor(gf.y() / chart_.height);
        gf -= turns * Vector2d(chart_.shear, chart_.height);
    }
    if (chart_.shape != ChartShape::Rectangle) {
        gf.x() -= std::floor(gf.x() / chart_.width) * chart_.width;
    }
    return gf;
}

std::vector<ChartSampler::Copy> ChartSampler::copies_of(int triangle) const {
    if (chart_.shape == ChartShape::Rectangle) {
        return {{.triangle = triangle, .shift = Vector2d::Zero()}};
    }
    const Range range = range_of(chart_.corner_gf[static_cast<std::size_t>(triangle)]);
    int first_turn = 0;
    int last_turn = 0;
    if (chart_.shape == ChartShape::Torus) {
        first_turn = static_cast<int>(std::ceil(-range.high.y() / chart_.height));
        last_turn = static_cast<int>(std::floor(1.0 - range.low.y() / chart_.height));
    }
    std::vector<Copy> copies;
    for (int turn = first_turn; turn <= last_turn; ++turn) {
        const Vector2d moved(turn * chart_.shear, turn * chart_.height);
        const double low = range.low.x() + moved.x();
        const double high = range.high.x() + moved.x();
        const int last = static_cast<int>(std::floor(1.0 - low / chart_.width));
        for (int k = static_cast<int>(std::ceil(-high / chart_.width)); k <= last; ++k) {
            copies.push_back(
                {.triangle = triangle, .shift = moved + Vector2d(k * chart_.width, 0.0)});
        }
    }
    return copies;
}

void ChartSampler::look_in_bin(std::size_t bin, const Vector2d& gf, Candidate& best) const {
    for (std::size_t i = bin_starts_[bin]; i < bin_starts_[bin + 1]; ++i) {
        const Copy& copy = entries_[i];
        const Vector3d found =
            barycentric(chart_.corner_gf[static_cast<std::size_t>(copy.triangle)], gf - copy.shift);
        if (best.triangle < 0 || found.minCoeff() > best.barycentric.minCoeff()) {
            best = {.triangle = copy.triangle, .barycentric = found};
        }
    }
}

Vector3d ChartSampler::point(const Vector2d& gf) const {
    const Vector2d at = reduced(gf);
    const int column = bin_column(at.x());
    const int row = bin_row(at.y());
    Candidate best;
    look_in_bin(bin(column, row), at, best);
    // A point in a crack between two triangles of neighbouring bins, or beyond a boundary that is
    // not quite straight: widen the search until some triangle is near enough.
    const int widest = std::max(columns_, rows_);
    for (int ring = 1; ring <= widest; ring *= 2) {
        if (best.triangle >= 0 && best.barycentric.minCoeff() >= kInside) {
            break;
        }
        if (best.triangle >= 0 && ring > 2) {
            break;
        }
        for (int r = std::max(0, row - ring); r <= std::min(rows_ - 1, row + ring); ++r) {
            for (int c = std::max(0, column - ring); c <= std::min(columns_ - 1, column + ring);
                 ++c) {
                look_in_bin(bin(c, r), at, best);
            }
        }
    }
    Vector3d weights = best.barycentric.cwiseMax(0.0);
    weights /= weights.sum();
    const auto& corners = chart_.mesh.triangles[static_cast<std::size_t>(best.triangle)];
    return weights.x() * chart_.mesh.positions[static_cast<std::size_t>(corners[0])] +
           weights.y() * chart_.mesh.positions[static_cast<std::size_t>(corners[1])] +
           weights.z() * chart_.mesh.positions[static_cast<std::size_t>(corners[2])];
}

}  // namespace leafcutter::geometry
