#include "fab/cut/lead_in.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "fab/cut/path_walk.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr double kSlackMm = 0.02;  // The way of the beam lies this near to where it should.
constexpr double kPierceMm = 0.1;  // A hole is wider than a cut.
constexpr double kNarrowestMm = 0.01;
constexpr double kFromTabMm = 0.5;

// Away from the path first, then more and more along it.
constexpr std::array<double, 7> kTurnsDeg{0.0, 30.0, -30.0, 55.0, -55.0, 75.0, -75.0};

// To the right of the path, between its two directions at a corner.
Vector2d outward_at(const Polyline& points, double at_mm) {
    const std::vector<double> stations = stations_mm(points);
    constexpr double kStepMm = 1e-3;
    const double length = stations.back();
    const bool closed = points.front() == points.back();
    const auto place = [&](double at) {
        return point_at(
            points, stations,
            closed ? at - length * std::floor(at / length) : std::clamp(at, 0.0, length));
    };
    const Vector2d here = place(at_mm);
    const Vector2d along = (here - place(at_mm - kStepMm)).stableNormalized() +
                           (place(at_mm + kStepMm) - here).stableNormalized();
    return Vector2d(along.y(), -along.x()).stableNormalized();
}

}  // namespace

LeadInRoom::LeadInRoom(const Sheet& sheet, std::span<const Ring> outlines, double kerf_mm)
    : outlines_({sheet.size.width_mm, sheet.size.height_mm}),
      tabs_({sheet.size.width_mm, sheet.size.height_mm}),
      extent_(sheet.size.width_mm, sheet.size.height_mm),
      remnant_(sheet.outline),
      kerf_mm_(kerf_mm) {
    for (const Ring& outline : outlines) {
        outlines_.add(outline);
    }
}

void LeadInRoom::keep_from(const Segment& tab) {
    tabs_.add({tab.from, tab.to});
}

std::optional<Vector2d> LeadInRoom::begin(const Polyline& points,
                                          double at_mm,
                                          double length_mm) const {
    const Vector2d start = point_at(points, stations_mm(points), at_mm);
    const Vector2d outward = outward_at(points, at_mm);
    for (const double turn : kTurnsDeg) {
        const Vector2d way = Eigen::Rotation2Dd(turn / 180.0 * std::numbers::pi) * outward;
        const Vector2d begin = start + length_mm * way;
        if (is_free(begin, start)) {
            return begin;
        }
    }
    return std::nullopt;
}

bool LeadInRoom::is_free(const Vector2d& begin, const Vector2d& start) const {
    const double half = kerf_mm_ / 2.0;
    if ((begin.array() < half).any() || ((extent_ - begin).array() < half).any() ||
        (!remnant_.empty() && !contains(remnant_, begin))) {
        return false;
    }
    const Vector2d near = start + std::max(kSlackMm, kNarrowestMm) * (begin - start).normalized();
    const Vector2d still = Vector2d::Zero();
    return !outlines_.collides({begin, near}, still, std::max(kNarrowestMm, half - kSlackMm)) &&
           !outlines_.collides({begin, begin}, still, half + kPierceMm) &&
           !tabs_.collides({begin, start}, still, kFromTabMm);
}

}  // namespace leafcutter::fab
