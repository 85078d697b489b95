#include "fab/nest/rotations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace leafcutter::fab {

namespace {

// How far an angle lies beyond an interval, below (< 0) or above (> 0) it; 0 inside.
double beyond(const AngleInterval& interval, double angle_deg) {
    const double half = (interval.to_deg - interval.from_deg) / 2.0;
    const double off = std::remainder(angle_deg - (interval.from_deg + half), 360.0);
    return std::abs(off) <= half ? 0.0 : off - std::copysign(half, off);
}

double weight(const AngleInterval& interval) {
    return std::max(1.0, interval.to_deg - interval.from_deg);
}

}  // namespace

Rotations::Rotations(std::initializer_list<double> angles_deg)
    : Rotations(std::vector<double>(angles_deg)) {}

Rotations::Rotations(const std::vector<double>& angles_deg) {
    intervals_.reserve(angles_deg.size());
    for (const double angle : angles_deg) {
        intervals_.push_back({angle, angle});
    }
}

Rotations::Rotations(std::vector<AngleInterval> intervals) : intervals_(std::move(intervals)) {
    const bool whole =
        std::any_of(intervals_.begin(), intervals_.end(),
                    [](const AngleInterval& each) { return each.to_deg - each.from_deg >= 360.0; });
    if (whole) {
        intervals_.clear();
    }
}

bool Rotations::is_list() const {
    return !empty() &&
           std::all_of(intervals_.begin(), intervals_.end(),
                       [](const AngleInterval& each) { return each.from_deg == each.to_deg; });
}

bool Rotations::allows(double angle_deg, double tolerance_deg) const {
    return empty() ||
           std::any_of(intervals_.begin(), intervals_.end(), [&](const AngleInterval& each) {
               return std::abs(beyond(each, angle_deg)) <= tolerance_deg;
           });
}

double Rotations::nearest(double angle_deg) const {
    double least = std::numeric_limits<double>::infinity();
    double best = angle_deg;
    for (const AngleInterval& each : intervals_) {
        const double off = beyond(each, angle_deg);
        if (std::abs(off) < least) {
            least = std::abs(off);
            // The ends themselves, without the rounding of a difference.
            best = off == 0.0 ? angle_deg : (off > 0.0 ? each.to_deg : each.from_deg);
        }
    }
    return best;
}

double Rotations::step(double angle_deg, double by_deg) const {
    if (empty()) {
        return by_deg;
    }
    double least = std::numeric_limits<double>::infinity();
    AngleInterval own;
    for (const AngleInterval& each : intervals_) {
        if (const double off = std::abs(beyond(each, angle_deg)); off < least) {
            least = off;
            own = each;
        }
    }
    const double half = (own.to_deg - own.from_deg) / 2.0;
    const double at = std::remainder(angle_deg - (own.from_deg + half), 360.0);
    return std::clamp(at + by_deg, -half, half) - at;
}

double Rotations::at_share(double share) const {
    if (empty()) {
        return 360.0 * share - 180.0;
    }
    double whole = 0.0;
    for (const AngleInterval& each : intervals_) {
        whole += weight(each);
    }
    double left = share * whole;
    for (const AngleInterval& each : intervals_) {
        if (left < weight(each)) {
            return each.from_deg + left / weight(each) * (each.to_deg - each.from_deg);
        }
        left -= weight(each);
    }
    return intervals_.back().to_deg;
}

std::vector<double> Rotations::samples() const {
    constexpr double kStepDeg = 3.0;
    std::vector<double> angles;
    for (const AngleInterval& each : intervals_) {
        const double room = each.to_deg - each.from_deg;
        const int steps = room > 0.0 ? 2 * static_cast<int>(std::ceil(room / kStepDeg / 2.0)) : 0;
        for (int i = 0; i <= steps; ++i) {
            angles.push_back(i == steps ? each.to_deg : each.from_deg + room * i / steps);
        }
    }
    return angles;
}

Rotations Rotations::shifted(double by_deg) const {
    Rotations out = *this;
    for (AngleInterval& each : out.intervals_) {
        const double from = std::remainder(each.from_deg + by_deg, 360.0);
        each.to_deg = from + (each.to_deg - each.from_deg);
        each.from_deg = from;
    }
    return out;
}

}  // namespace leafcutter::fab
