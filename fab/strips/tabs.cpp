#include "fab/strips/tabs.h"

#include <algorithm>
#include <array>

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr double kInsetMm = 0.5;
constexpr double kInsetPart = 0.1;  // At most this part of the width.

// Of arrows. The slit is wider than the neck by the play, the head wider than the slit by the hold.
constexpr double kShortestArrowMm = 5.0;
constexpr double kSlitPart = 0.4;   // Of the tab's length, from the joint to the slit.
constexpr double kNeckPart = 0.45;  // Of the strip's width.
constexpr double kPlayMm = 0.6;
constexpr double kHoldMm = 1.0;
constexpr double kLargestHead = 0.9;  // Of the strip's width.
constexpr double kNeckMm = 0.8;       // Length of the neck.
constexpr double kTipPart = 0.6;      // Of the neck's width.

// A rung at `at` from the first one.
struct Rung {
    Vector2d left;
    Vector2d right;
};

Rung rung_at(const Band& band, double at) {
    double length = 0.0;
    for (std::size_t i = 0; i + 1 < band.rungs(); ++i) {
        const double step = (band.middle(i + 1) - band.middle(i)).norm();
        if (length + step >= at || i + 2 == band.rungs()) {
            const double part = step > 0.0 ? std::clamp((at - length) / step, 0.0, 1.0) : 0.0;
            return {band.left[i] + part * (band.left[i + 1] - band.left[i]),
                    band.right[i] + part * (band.right[i + 1] - band.right[i])};
        }
        length += step;
    }
    return {band.left.back(), band.right.back()};
}

void add_scaled(const Rung& rung, double width_mm, Band& tab) {
    const Vector2d middle = (rung.left + rung.right) / 2.0;
    const Vector2d half = (rung.left - rung.right).stableNormalized() * width_mm / 2.0;
    tab.left.emplace_back(middle + half);
    tab.right.emplace_back(middle - half);
}

double inset_width(double width_mm, double min_width_mm) {
    const double inset = std::min(2.0 * kInsetMm, 2.0 * kInsetPart * width_mm);
    return std::max(width_mm - inset, std::min(width_mm, min_width_mm));
}

}  // namespace

double length_of(const Band& band) {
    double length = 0.0;
    for (std::size_t i = 1; i < band.rungs(); ++i) {
        length += (band.middle(i) - band.middle(i - 1)).norm();
    }
    return length;
}

Band cut_off(const Band& band, double length_mm) {
    Band result;
    double length = 0.0;
    for (std::size_t i = 0; i < band.rungs(); ++i) {
        const double step = i > 0 ? (band.middle(i) - band.middle(i - 1)).norm() : 0.0;
        if (length + step > length_mm) {
            const double part = (length_mm - length) / step;
            result.left.emplace_back(band.left[i - 1] + part * (band.left[i] - band.left[i - 1]));
            result.right.emplace_back(band.right[i - 1] +
                                      part * (band.right[i] - band.right[i - 1]));
            break;
        }
        length += step;
        result.left.push_back(band.left[i]);
        result.right.push_back(band.right[i]);
    }
    return result;
}

Band reversed(const Band& band) {
    return {{band.right.rbegin(), band.right.rend()}, {band.left.rbegin(), band.left.rend()}};
}

Band glue_tab(const Band& band, double length_mm, double min_width_mm) {
    const Band whole = cut_off(band, length_mm);
    Band tab;
    for (std::size_t i = 0; i < whole.rungs(); ++i) {
        add_scaled({whole.left[i], whole.right[i]}, inset_width(whole.width(i), min_width_mm), tab);
    }
    return tab;
}

std::optional<ArrowTab> arrow_tab(const Band& band, double length_mm, double min_width_mm) {
    const double length = std::max(length_mm, kShortestArrowMm);
    if (band.rungs() < 2 || length_of(band) < length) {
        return std::nullopt;
    }
    const double slit_at = kSlitPart * length;
    const auto width_at = [&](double at) {
        const Rung rung = rung_at(band, at);
        return (rung.left - rung.right).norm();
    };
    const double width = std::min(width_at(slit_at), width_at(slit_at + kNeckMm));
    const double neck = std::max(kNeckPart * width, min_width_mm);
    const double slit = neck + kPlayMm;
    const double head = std::max(slit + kHoldMm, (slit + kLargestHead * width) / 2.0);
    if (head > kLargestHead * width) {
        return std::nullopt;
    }
    ArrowTab result;
    result.arrow = {.slit_at_mm = slit_at, .slit_width_mm = slit};
    // The body is laid straight from rung to rung: it is a few millimetres long.
    const double neck_from = slit_at - kNeckMm / 4.0;
    const double neck_to = slit_at + 3.0 * kNeckMm / 4.0;
    result.band = glue_tab(band, neck_from, min_width_mm);
    add_scaled(rung_at(band, neck_from), neck, result.band);
    add_scaled(rung_at(band, neck_to), neck, result.band);
    add_scaled(rung_at(band, neck_to), head, result.band);
    add_scaled(rung_at(band, length), std::max(kTipPart * neck, min_width_mm), result.band);
    return result;
}

}  // namespace leafcutter::fab
