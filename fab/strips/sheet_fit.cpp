#include "fab/strips/sheet_fit.h"

#include <limits>

#include "fab/nest/shape.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

// Sheets are taken this much smaller, for placements that are rounded.
constexpr double kSheetSlackMm = 0.01;

struct Extent {
    double width = 0.0;
    double height = 0.0;
};

Extent extent_along(const Ring& hull, const Vector2d& x) {
    const Vector2d y(-x.y(), x.x());
    Vector2d low = Vector2d::Constant(std::numeric_limits<double>::infinity());
    Vector2d high = -low;
    for (const Vector2d& point : hull) {
        const Vector2d turned(x.dot(point), y.dot(point));
        low = low.cwiseMin(turned);
        high = high.cwiseMax(turned);
    }
    return {high.x() - low.x(), high.y() - low.y()};
}

}  // namespace

bool fits_sheet(const Ring& outline, const SheetSize& usable, Rotation rotation) {
    if (outline.size() < 3) {
        return false;
    }
    const Ring hull = convex_hull(outline);
    const double width = usable.width_mm - kSheetSlackMm;
    const double height = usable.height_mm - kSheetSlackMm;
    const auto upright = [&](const Extent& e) { return e.width <= width && e.height <= height; };
    const auto lying = [&](const Extent& e) { return e.height <= width && e.width <= height; };
    const Extent as_drawn = extent_along(hull, Vector2d::UnitX());
    if (upright(as_drawn)) {
        return true;
    }
    if (rotation == Rotation::Half || rotation == Rotation::Fixed) {
        return false;
    }
    if (lying(as_drawn)) {
        return true;
    }
    for (std::size_t i = 0; i < hull.size() && rotation == Rotation::Free; ++i) {
        const Vector2d edge = hull[(i + 1) % hull.size()] - hull[i];
        const Extent turned = extent_along(hull, edge.stableNormalized());
        if (upright(turned) || lying(turned)) {
            return true;
        }
    }
    return false;
}

}  // namespace leafcutter::fab
