#include "fab/strips/fit.h"

#include <algorithm>
#include <cmath>

#include "fab/strips/overlap.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

// A tab is this much narrower on each side, so that it hides under the piece it is glued to.
constexpr double kTabInsetMm = 0.5;
constexpr double kTabInsetPart = 0.1;  // At most this part of the width.

struct Band {
    Polyline left;
    Polyline right;

    std::size_t rungs() const { return left.size(); }
    Vector2d middle(std::size_t i) const { return (left[i] + right[i]) / 2.0; }
    double width(std::size_t i) const { return (left[i] - right[i]).norm(); }
};

Band crimped(const Unfolded& flat, double thickness_mm) {
    Band band{flat.left, flat.right};
    Vector2d shift = Vector2d::Zero();
    for (std::size_t i = 1; i < band.rungs(); ++i) {
        const Vector2d step =
            (flat.left[i] + flat.right[i] - flat.left[i - 1] - flat.right[i - 1]) / 2.0;
        const double length = step.norm();
        const double more = std::min(std::hypot(length, thickness_mm) - length, kMaxCrimp * length);
        if (length > 0.0) {
            shift += more / length * step;
        }
        band.left[i] += shift;
        band.right[i] += shift;
    }
    return band;
}

// How far an end of rung i moves along the rung for its side to move by `clearance_mm`.
double along_rung(const Polyline& side, std::size_t i, const Vector2d& rung, double clearance_mm) {
    const Vector2d& before = side[i > 0 ? i - 1 : i];
    const Vector2d& after = side[i + 1 < side.size() ? i + 1 : i];
    const Vector2d tangent = (after - before).stableNormalized();
    const double sine = std::abs(tangent.x() * rung.y() - tangent.y() * rung.x());
    return clearance_mm / std::max(sine, 0.5);
}

// Moves both ends of every rung inward; `least` is the width that stays.
Band narrowed(const Band& band, double clearance_mm, double least) {
    Band result = band;
    for (std::size_t i = 0; i < band.rungs(); ++i) {
        const double width = band.width(i);
        if (width <= least || clearance_mm <= 0.0) {
            continue;
        }
        const Vector2d rung = (band.right[i] - band.left[i]) / width;
        const double left = along_rung(band.left, i, rung, clearance_mm);
        const double right = along_rung(band.right, i, rung, clearance_mm);
        const double scale = std::min(1.0, (width - least) / (left + right));
        result.left[i] += scale * left * rung;
        result.right[i] -= scale * right * rung;
    }
    return result;
}

// The rungs of the tab, from the first after the piece's last rung to its end.
Band tab_of(const Band& band, std::size_t last, double tab_mm) {
    Band tab;
    double length = 0.0;
    for (std::size_t i = last; i + 1 < band.rungs() && length < tab_mm; ++i) {
        const double step = (band.middle(i + 1) - band.middle(i)).norm();
        const double part = step > tab_mm - length ? (tab_mm - length) / step : 1.0;
        length += part * step;
        const Vector2d left = band.left[i] + part * (band.left[i + 1] - band.left[i]);
        const Vector2d right = band.right[i] + part * (band.right[i + 1] - band.right[i]);
        const double width = (left - right).norm();
        const double inset = std::min(kTabInsetMm / std::max(width, 1e-9), kTabInsetPart);
        tab.left.push_back(left + inset * (right - left));
        tab.right.push_back(right + inset * (left - right));
    }
    return tab;
}

double centre_length(const Band& band) {
    double length = 0.0;
    for (std::size_t i = 1; i < band.rungs(); ++i) {
        length += (band.middle(i) - band.middle(i - 1)).norm();
    }
    return length;
}

}  // namespace

Fitted fit_piece(const Unfolded& flat, int cell_count, const FitOptions& options) {
    const auto last = static_cast<std::size_t>(cell_count);
    const Band crimp = crimped(flat, options.crimp_thickness_mm);
    Band cut = narrowed(crimp, options.clearance_mm, options.min_width_mm);
    const Band tab = tab_of(cut, last, options.tab_mm);
    cut.left.resize(last + 1);
    cut.right.resize(last + 1);

    Fitted fitted;
    Ring ring(cut.right.begin(), cut.right.end());
    ring.insert(ring.end(), tab.right.begin(), tab.right.end());
    ring.insert(ring.end(), tab.left.rbegin(), tab.left.rend());
    ring.insert(ring.end(), cut.left.rbegin(), cut.left.rend());
    fitted.outline = snapped(ring);
    fitted.length_mm = centre_length(cut);
    if (tab.rungs() > 0) {
        fitted.length_mm += (tab.middle(0) - cut.middle(last)).norm() + centre_length(tab);
    }
    for (std::size_t i = 0; i <= last; ++i) {
        fitted.narrow_rungs += crimp.width(i) < options.min_width_mm ? 1 : 0;
    }
    fitted.left = std::move(cut.left);
    fitted.right = std::move(cut.right);
    return fitted;
}

}  // namespace leafcutter::fab
