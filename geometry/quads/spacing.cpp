#include "geometry/quads/spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/plane.h"

namespace leafcutter::geometry {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The mean over a leaf is the power mean of this order of the conformal factor. Order 1 still
// leaves a limb, which is a small part of its leaves, to a few huge cells; a high order narrows a
// whole strip for the sake of its widest cell. Measured on faces, busts, hands and tori: 3 takes
// the variation of cell areas to a half or less and what limbs lose to a third, at the same mean
// angles.
constexpr double kOrder = 3.0;

// Levels this close to even ones, of the whole length, are even: the rest is rounding.
constexpr double kEven = 1e-9;

// A share of the density: the same everywhere between two levels.
struct Band {
    double from = 0.0;
    double to = 0.0;
    double density = 0.0;
    double leaf_mm = 0.0;  // Mean length of a leaf inside.
};

double area_on_surface(const TriangleMesh& mesh, std::size_t triangle) {
    const auto& corners = mesh.triangles[triangle];
    const Vector3d& a = mesh.positions[static_cast<std::size_t>(corners[0])];
    const Vector3d& b = mesh.positions[static_cast<std::size_t>(corners[1])];
    const Vector3d& c = mesh.positions[static_cast<std::size_t>(corners[2])];
    return 0.5 * (b - a).cross(c - a).norm();
}

// The integral of a linear function's gradient over a triangle: by the coarea formula that of the
// lengths of its level lines.
double gradient_integral(const TriangleMesh& mesh,
                         std::size_t triangle,
                         const std::array<double, 3>& values) {
    const auto& corners = mesh.triangles[triangle];
    const Vector3d& a = mesh.positions[static_cast<std::size_t>(corners[0])];
    const Vector3d& b = mesh.positions[static_cast<std::size_t>(corners[1])];
    const Vector3d& c = mesh.positions[static_cast<std::size_t>(corners[2])];
    return 0.5 * (values[0] * (c - b) + values[1] * (a - c) + values[2] * (b - a)).norm();
}

double area_in_chart(const std::array<Vector2d, 3>& gf) {
    const Vector2d u = gf[1] - gf[0];
    const Vector2d v = gf[2] - gf[0];
    return 0.5 * std::abs(turn_of(u, v));
}

// Where the level axis is a circle, bands are cut at its ends.
void add_band(const Band& band, double length, bool closed, std::vector<Band>& bands) {
    if (!closed) {
        bands.push_back(band);
        bands.back().from = std::clamp(band.from, 0.0, length);
        bands.back().to = std::clamp(band.to, 0.0, length);
        return;
    }
    const double turn = std::floor(band.from / length) * length;
    const double from = band.from - turn;
    const double to = band.to - turn;
    bands.push_back({from, std::min(to, length), band.density, band.leaf_mm});
    if (to > length) {
        bands.push_back({0.0, std::min(to - length, length), band.density, band.leaf_mm});
    }
}

std::vector<Band> bands_of(const Cylinder& chart, Axis axis, double slant) {
    const bool along = axis == Axis::F;
    const bool closed =
        along ? chart.shape == ChartShape::Torus : chart.shape != ChartShape::Rectangle;
    const double length = along ? chart.height : chart.width;
    const double across = along ? chart.width : chart.height;
    std::vector<Band> bands;
    for (std::size_t t = 0; t < chart.corner_gf.size(); ++t) {
        const auto& gf = chart.corner_gf[t];
        const auto level = [&](const Vector2d& place) {
            return along ? place.y() : place.x() - slant * place.y();
        };
        const std::array<double, 3> values{level(gf[0]), level(gf[1]), level(gf[2])};
        const auto [low, high] = std::minmax_element(values.begin(), values.end());
        const double from = *low;
        const double to = *high;
        const double in_chart = area_in_chart(gf);
        if (!(to > from) || !(in_chart > 0.0)) {
            continue;
        }
        const double factor = std::sqrt(area_on_surface(chart.mesh, t) / in_chart);
        const double share = in_chart / ((to - from) * across);
        add_band({.from = from,
                  .to = to,
                  .density = share * std::pow(factor, kOrder),
                  .leaf_mm = gradient_integral(chart.mesh, t, values) / (to - from)},
                 length, closed, bands);
    }
    return bands;
}

// The density in each interval between neighbouring places. Sums of positive shares only: densities
// differ by many orders of magnitude, and a running sum that takes shares out again would drown the
// small ones in the rounding of the large.
std::vector<double> densities(const std::vector<double>& places, const std::vector<Band>& bands) {
    const std::size_t count = places.size() - 1;
    std::vector<double> tree(2 * count, 0.0);  // Segment tree: leaves at [count, 2 count).
    const auto index_of = [&places](double place) {
        return static_cast<std::size_t>(std::lower_bound(places.begin(), places.end(), place) -
                                        places.begin());
    };
    for (const Band& band : bands) {
        std::size_t left = index_of(band.from) + count;
        std::size_t right = index_of(band.to) + count;
        for (; left < right; left /= 2, right /= 2) {
            if (left % 2 == 1) {
                tree[left++] += band.density;
            }
            if (right % 2 == 1) {
                tree[--right] += band.density;
            }
        }
    }
    for (std::size_t node = 1; node < count; ++node) {
        tree[2 * node] += tree[node];
        tree[2 * node + 1] += tree[node];
    }
    return {tree.begin() + static_cast<std::ptrdiff_t>(count), tree.end()};
}

}  // namespace

LevelScale::LevelScale(const Cylinder& chart, Axis axis, double slant)
    : length_(axis == Axis::F ? chart.height : chart.width) {
    const std::vector<Band> bands = bands_of(chart, axis, slant);
    places_ = {0.0, length_};
    for (const Band& band : bands) {
        places_.push_back(band.from);
        places_.push_back(band.to);
    }
    std::sort(places_.begin(), places_.end());
    places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
    const std::vector<double> density = densities(places_, bands);
    cumulated_.push_back(0.0);
    for (std::size_t i = 0; i < density.size(); ++i) {
        cumulated_.push_back(cumulated_.back() +
                             std::pow(density[i], 1.0 / kOrder) * (places_[i + 1] - places_[i]));
    }
    const auto width_below = [this](double place) {
        const auto at = std::lower_bound(places_.begin(), places_.end(), place) - places_.begin();
        return cumulated_[static_cast<std::size_t>(at)];
    };
    for (const Band& band : bands) {
        mean_even_leaf_ += band.leaf_mm * (band.to - band.from) / length_;
        mean_leaf_ += band.leaf_mm * (width_below(band.to) - width_below(band.from)) / total_mm();
    }
}

std::vector<double> LevelScale::levels(int count) const {
    std::vector<double> levels{0.0};
    std::vector<double> even{0.0};
    double farthest = 0.0;
    std::size_t at = 0;
    for (int i = 1; i < count; ++i) {
        const double wanted = total_mm() * i / count;
        while (at + 2 < cumulated_.size() && cumulated_[at + 1] < wanted) {
            ++at;
        }
        const double step = cumulated_[at + 1] - cumulated_[at];
        const double part = step > 0.0 ? (wanted - cumulated_[at]) / step : 0.0;
        levels.push_back(places_[at] + part * (places_[at + 1] - places_[at]));
        even.push_back(length_ * i / count);
        farthest = std::max(farthest, std::abs(levels.back() - even.back()));
    }
    levels.push_back(length_);
    even.push_back(length_);
    return farthest <= kEven * length_ ? even : levels;
}

}  // namespace leafcutter::geometry
