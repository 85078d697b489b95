#include "fab/strips/fit.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "fab/strips/overlap.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::angle_between;
using geometry::turn_of;

namespace {

using Eigen::Vector2d;

// A strip narrower than this part of its least width is no strip.
constexpr double kHopelessPart = 0.2;

// A rung that stands more obliquely than this is measured as if it stood so.
constexpr double kLeastSine = 0.5;

// Where the middle line turns by more than this in radians, the inner side isn't widened.
constexpr double kTurns = 0.1;

Band crimped(const Unfolded& flat, const std::vector<double>& extra_mm) {
    Band band{flat.left, flat.right};
    Vector2d shift = Vector2d::Zero();
    for (std::size_t i = 1; i < band.rungs(); ++i) {
        const Vector2d step =
            (flat.left[i] + flat.right[i] - flat.left[i - 1] - flat.right[i - 1]) / 2.0;
        const double length = step.norm();
        if (length > 0.0 && i <= extra_mm.size()) {
            shift += extra_mm[i - 1] / length * step;
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
    const double sine = std::abs(turn_of(tangent, rung));
    return clearance_mm / std::max(sine, 0.5);
}

// A rung as part of its band.
struct Stance {
    Vector2d rung = Vector2d::Zero();  // Unit, left to right.
    double sine = 1.0;                 // Of its angle with the middle line: across over along.
    double turn = 0.0;                 // Of the middle line there, radians, to the left.
};

class Widths {
public:
    explicit Widths(const Band& band) : band_(band) {
        for (std::size_t i = 0; i < band.rungs(); ++i) {
            stances_.push_back(stance(i));
        }
    }

    const Stance& operator[](std::size_t i) const { return stances_[i]; }
    double across(std::size_t i) const { return band_.width(i) * stances_[i].sine; }

private:
    // Middle line's way into or out of rung i, unit; zero at the ends.
    Vector2d step(std::size_t from, std::size_t to) const {
        return (band_.middle(to) - band_.middle(from)).stableNormalized();
    }

    Stance stance(std::size_t i) const {
        const Vector2d in = i > 0 ? step(i - 1, i) : Vector2d::Zero();
        const Vector2d out = i + 1 < band_.rungs() ? step(i, i + 1) : Vector2d::Zero();
        const Vector2d way = (in + out).stableNormalized();
        Stance result;
        result.rung = (band_.right[i] - band_.left[i]).stableNormalized();
        if (band_.width(i) < 1e-6) {
            result.rung = Vector2d(way.y(), -way.x());
        }
        const auto sine = [&](const Vector2d& tangent) {
            return tangent.squaredNorm() < 0.5 ? 1.0 : std::abs(turn_of(tangent, result.rung));
        };
        result.sine = std::max(kLeastSine, std::min(sine(in), sine(out)));
        result.turn = angle_between(in, out);
        return result;
    }

    const Band& band_;
    std::vector<Stance> stances_;
};

// How much of what a rung is widened by goes to its left end.
double left_share(double turn, Widening widening) {
    if (widening == Widening::BothSides || std::abs(turn) < kTurns) {
        return 0.5;
    }
    return turn > 0.0 ? 0.0 : 1.0;
}

// Moves the ends of every rung: inward by the clearance, but apart to the least width.
Band with_widths(const Band& band, const Widths& widths, const FitOptions& options) {
    Band result = band;
    for (std::size_t i = 0; i < band.rungs(); ++i) {
        const Stance& stance = widths[i];
        const double width = band.width(i);
        const double least = options.min_width_mm / stance.sine;
        if (width > least && options.clearance_mm > 0.0) {
            const double left = along_rung(band.left, i, stance.rung, options.clearance_mm);
            const double right = along_rung(band.right, i, stance.rung, options.clearance_mm);
            const double scale = std::min(1.0, (width - least) / (left + right));
            result.left[i] += scale * left * stance.rung;
            result.right[i] -= scale * right * stance.rung;
        } else if (width < least && options.widening != Widening::None) {
            const double share = left_share(stance.turn, options.widening);
            result.left[i] -= share * (least - width) * stance.rung;
            result.right[i] += (1.0 - share) * (least - width) * stance.rung;
        }
    }
    return result;
}

Band part_of(const Band& band, std::size_t from, std::size_t to) {
    const auto part = [&](const Polyline& side) {
        return Polyline(side.begin() + static_cast<std::ptrdiff_t>(from),
                        side.begin() + static_cast<std::ptrdiff_t>(to) + 1);
    };
    return {part(band.left), part(band.right)};
}

// The part of the way between two widths, changing evenly, on which they are below a limit.
double part_below(double one, double other, double limit) {
    const double low = std::min(one, other);
    const double high = std::max(one, other);
    if (low >= limit) {
        return 0.0;
    }
    return high <= limit ? 1.0 : (limit - low) / (high - low);
}

NarrowPlaces narrow_places(const Band& band,
                           const Widths& widths,
                           const CellRun& cells,
                           double min_width_mm) {
    NarrowPlaces narrow;
    const auto first = static_cast<std::size_t>(cells.first);
    const std::size_t last = first + static_cast<std::size_t>(cells.count);
    narrow.least_mm = widths.across(first);
    for (std::size_t i = first; i <= last; ++i) {
        const double across = widths.across(i);
        narrow.least_mm = std::min(narrow.least_mm, across);
        narrow.widened_mm = std::max(narrow.widened_mm, min_width_mm - across);
        if (i < last) {
            narrow.hopeless_mm +=
                (band.middle(i + 1) - band.middle(i)).norm() *
                part_below(across, widths.across(i + 1), kHopelessPart * min_width_mm);
        }
    }
    return narrow;
}

struct Tabs {
    Band start;  // Towards the joint.
    Band end;
};

Tabs make_tabs(const Band& cut, const CellRun& cells, const FitOptions& options, Fitted& fitted) {
    Tabs tabs;
    const auto first = static_cast<std::size_t>(cells.first);
    const std::size_t last = first + static_cast<std::size_t>(cells.count);
    if (options.start_tab_mm > 0.0 && first > 0) {
        const Band before = reversed(part_of(cut, 0, first));
        tabs.start = reversed(glue_tab(before, options.start_tab_mm, options.min_width_mm));
        fitted.start_tab_mm = length_of(tabs.start);
    }
    if (options.end_tab_mm > 0.0 && last + 1 < cut.rungs()) {
        const Band behind = part_of(cut, last, cut.rungs() - 1);
        std::optional<ArrowTab> arrow;
        if (options.arrow) {
            arrow = arrow_tab(behind, options.end_tab_mm, options.min_width_mm);
        }
        if (arrow) {
            fitted.arrow = arrow->arrow;
            tabs.end = std::move(arrow->band);
        } else {
            tabs.end = glue_tab(behind, options.end_tab_mm, options.min_width_mm);
        }
        fitted.end_tab_mm = length_of(tabs.end);
    }
    return tabs;
}

}  // namespace

Fitted fit_piece(const Unfolded& flat, const CellRun& cells, const FitOptions& options) {
    const Band crimp = crimped(flat, options.extra_mm);
    const Widths widths(crimp);
    const Band cut = with_widths(crimp, widths, options);
    Fitted fitted;
    fitted.narrow = narrow_places(crimp, widths, cells, options.min_width_mm);
    const Tabs tabs = make_tabs(cut, cells, options, fitted);
    const auto first = static_cast<std::size_t>(cells.first);
    const Band piece = part_of(cut, first, first + static_cast<std::size_t>(cells.count));

    Ring ring(tabs.start.right);
    for (const Polyline* side : {&piece.right, &tabs.end.right}) {
        ring.insert(ring.end(), side->begin(), side->end());
    }
    for (const Polyline* side : {&tabs.end.left, &piece.left, &tabs.start.left}) {
        ring.insert(ring.end(), side->rbegin(), side->rend());
    }
    fitted.outline = snapped(ring);
    fitted.between_mm = length_of(piece);
    fitted.length_mm = fitted.start_tab_mm + fitted.between_mm + fitted.end_tab_mm;
    fitted.left = piece.left;
    fitted.right = piece.right;
    return fitted;
}

}  // namespace leafcutter::fab
