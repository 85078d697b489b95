#include "fab/weave/thickness.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace leafcutter::fab {

namespace {

constexpr double kQuarter = std::numbers::pi / 2.0;

// A gap as wide as the strip is thick would have to be passed upright.
constexpr double kPassingSlack = 1.1;

constexpr double kAutomaticPart = 0.05;

double climb_of(const CrimpRule& rule) {
    return (rule.own_mm + rule.crossed_mm) / 2.0;
}

// How far the edges of the crossing strips reach into a slab of the strip's thickness that goes
// through the middle of the gap at this slope. The edges lie half a gap away, at half the
// difference of a quarter of both thicknesses.
double lift_of(const CrimpRule& rule, double angle_rad) {
    const double rise = (rule.crossed_mm - rule.own_mm) / 4.0;
    const double away = rule.gap_mm / 2.0 * std::sin(angle_rad) - rise * std::cos(angle_rad);
    return std::max(0.0, rule.own_mm / 2.0 - away);
}

}  // namespace

double flat_gap_mm(const CrimpRule& rule) {
    // Two arcs of radius r that climb D: r (1 - cos φ) = D / 2, run = 2 r sin φ; a quarter circle
    // at most, which needs 2 r.
    const double climb = climb_of(rule);
    const double radius = std::max(rule.min_radius_mm, rule.own_mm / 2.0);
    return climb >= 2.0 * radius ? 2.0 * radius : std::sqrt(climb * (4.0 * radius - climb));
}

CrimpPath crimp_path(const CrimpRule& rule, double spacing_mm) {
    CrimpPath path;
    path.climb_mm = climb_of(rule);
    if (path.climb_mm <= 0.0 || spacing_mm <= 0.0) {
        return {};
    }
    const double room = std::max(rule.gap_mm, flat_gap_mm(rule));
    path.run_mm = std::min(room, spacing_mm);
    if (path.climb_mm <= path.run_mm) {
        path.radius_mm =
            (path.run_mm * path.run_mm + path.climb_mm * path.climb_mm) / (4.0 * path.climb_mm);
        path.angle_rad = 2.0 * std::atan2(path.climb_mm, path.run_mm);
    } else {
        path.radius_mm = path.run_mm / 2.0;
        path.angle_rad = kQuarter;
        path.straight_mm = path.climb_mm - path.run_mm;
    }
    path.lift_mm = path.run_mm > rule.gap_mm ? lift_of(rule, path.angle_rad) : 0.0;
    return path;
}

std::vector<double> crimp_extra_mm(std::span<const Crossing> crossings,
                                   std::span<const double> cell_lengths_mm,
                                   const CrimpRule& rule,
                                   bool closed) {
    assert(crossings.size() == cell_lengths_mm.size());
    const std::size_t count = crossings.size();
    std::vector<double> extra(count, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t next = i + 1 < count ? i + 1 : 0;
        if ((next == 0 && !closed) || crossings[i].on_top == crossings[next].on_top) {
            continue;
        }
        const double spacing = (cell_lengths_mm[i] + cell_lengths_mm[next]) / 2.0;
        const double half = crimp_path(rule, spacing).extra_mm() / 2.0;
        extra[i] += half;
        extra[next] += half;
    }
    return extra;
}

ClearanceNeed clearance_need(const SheetFeel& weft, const SheetFeel& warp) {
    const CrimpRule of_weft{weft.thickness_mm, warp.thickness_mm, 0.0, weft.min_radius_mm};
    const CrimpRule of_warp{warp.thickness_mm, weft.thickness_mm, 0.0, warp.min_radius_mm};
    ClearanceNeed need;
    need.pass_mm = kPassingSlack * std::max(weft.thickness_mm, warp.thickness_mm) / 2.0;
    need.joint_mm = std::max(weft.thickness_mm, warp.thickness_mm);
    need.flat_mm = std::max({need.pass_mm, flat_gap_mm(of_weft) / 2.0, flat_gap_mm(of_warp) / 2.0});
    return need;
}

double automatic_clearance_mm(const ClearanceNeed& need, double strip_width_mm) {
    return std::max(need.joint_mm, std::min(need.flat_mm, kAutomaticPart * strip_width_mm));
}

}  // namespace leafcutter::fab
