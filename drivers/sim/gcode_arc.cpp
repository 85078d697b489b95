// Arcs of the simulated interpreter, after Grbl 1.1's gcode.c (checks) and motion_control.c
// (segments).

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/sim/gcode_block.h"

namespace leafcutter::drivers {

namespace {

struct Plane {
    std::size_t first;
    std::size_t second;
    std::size_t linear;
};

Plane plane_of(int code) {
    if (code == 18) {
        return {2, 0, 1};
    }
    return code == 19 ? Plane{1, 2, 0} : Plane{0, 1, 2};
}

}  // namespace

int GcodeInterpreter::check_arc(Block& block) const {
    const Plane plane = plane_of(block.modal.plane);
    if (!block.any_axis()) {
        return grbl_error::kNoAxisWords;
    }
    if (!block.axis_given[plane.first] && !block.axis_given[plane.second]) {
        return grbl_error::kNoAxisWordsInPlane;
    }
    const double x = block.target_mm[plane.first] - position_mm_[plane.first];
    const double y = block.target_mm[plane.second] - position_mm_[plane.second];
    if (block.r) {
        double radius = *block.r;
        if (x == 0.0 && y == 0.0) {
            return grbl_error::kBadTarget;
        }
        const double discriminant = 4.0 * radius * radius - x * x - y * y;
        if (discriminant < 0.0) {
            return grbl_error::kArcRadius;
        }
        double height = -std::sqrt(discriminant) / std::hypot(x, y);
        height = block.modal.motion == Motion::ArcCcw ? -height : height;
        height = radius < 0.0 ? -height : height;
        block.offsets[plane.first] = 0.5 * (x - y * height);
        block.offsets[plane.second] = 0.5 * (y + x * height);
        return 0;
    }
    if (!block.offset_given[plane.first] && !block.offset_given[plane.second]) {
        return grbl_error::kNoOffsetsInPlane;
    }
    const double i = block.offsets[plane.first];
    const double j = block.offsets[plane.second];
    const double radius = std::hypot(i, j);
    const double mismatch = std::abs(std::hypot(x - i, y - j) - radius);
    const bool too_far = mismatch > 0.5 || mismatch > 0.001 * radius;
    return mismatch > 0.005 && too_far ? grbl_error::kBadTarget : 0;
}

void GcodeInterpreter::add_arc(const Block& block,
                               const Rules& rules,
                               std::vector<Action>& actions) {
    const Plane plane = plane_of(block.modal.plane);
    const Axes start = position_mm_;
    const double i = block.offsets[plane.first];
    const double j = block.offsets[plane.second];
    const double centre_first = start[plane.first] + i;
    const double centre_second = start[plane.second] + j;
    const double radius = std::hypot(i, j);
    const double from = std::atan2(-j, -i);
    const double to_first = block.target_mm[plane.first] - centre_first;
    const double to_second = block.target_mm[plane.second] - centre_second;
    constexpr double kTinyAngle = 5e-7;  // Grbl's ARC_ANGULAR_TRAVEL_EPSILON: below, a full circle.
    double travel = std::atan2(-i * to_second + j * to_first, -i * to_first - j * to_second);
    if (block.modal.motion == Motion::ArcCw) {
        travel -= travel >= -kTinyAngle ? 2.0 * std::numbers::pi : 0.0;
    } else {
        travel += travel <= kTinyAngle ? 2.0 * std::numbers::pi : 0.0;
    }
    const double tolerance = rules.arc_tolerance_mm;
    const double chord = std::sqrt(std::max(tolerance * (2.0 * radius - tolerance), 1e-12));
    const double wanted = std::floor(std::abs(0.5 * travel * radius) / chord);
    const int segments = static_cast<int>(std::clamp(wanted, 1.0, 100000.0));
    Block piece = block;
    if (block.modal.inverse_time && wanted >= 1.0) {
        // The firmware forgets here that F is an inverse time: the pieces run at F times their
        // number as mm/min.
        piece.modal.feed_mm_per_min *= segments;
        piece.modal.inverse_time = false;
    }
    for (int k = 1; k < segments; ++k) {
        const double part = static_cast<double>(k) / segments;
        Axes point = start;
        point[plane.first] = centre_first + radius * std::cos(from + part * travel);
        point[plane.second] = centre_second + radius * std::sin(from + part * travel);
        point[plane.linear] += part * (block.target_mm[plane.linear] - start[plane.linear]);
        add_line(piece, rules, point, actions);
    }
    add_line(piece, rules, block.target_mm, actions);
}

}  // namespace leafcutter::drivers
