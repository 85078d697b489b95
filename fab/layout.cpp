#include "fab/layout.h"

#include <cmath>
#include <numbers>

namespace leafcutter::fab {

Eigen::Vector2d Placement::apply(const Eigen::Vector2d& point) const {
    const double angle = rotation_deg * std::numbers::pi / 180.0;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const double x = mirrored ? -point.x() : point.x();
    return {c * x - s * point.y() + x_mm, s * x + c * point.y() + y_mm};
}

}  // namespace leafcutter::fab
