#include "fab/nest/simple_ring.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "fab/nest/exact.h"
#include "fab/nest/shape.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

namespace {

int side(const WholePoint& o, const WholePoint& a, const WholePoint& b) {
    const std::int64_t cross = (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
    return cross > 0 ? 1 : (cross < 0 ? -1 : 0);
}

bool boxes_apart(const WholePoint& a,
                 const WholePoint& b,
                 const WholePoint& c,
                 const WholePoint& d) {
    return std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x) ||
           std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y);
}

// Crossing counts, touching doesn't: outlines that pinch are nested all the same.
bool cross_over(const WholePoint& a,
                const WholePoint& b,
                const WholePoint& c,
                const WholePoint& d) {
    return !boxes_apart(a, b, c, d) && side(a, b, c) * side(a, b, d) < 0 &&
           side(c, d, a) * side(c, d, b) < 0;
}

}  // namespace

std::string ring_fault(const Ring& ring) {
    if (ring.size() < 3) {
        return fmt::format("has {} corners, a polygon needs three", ring.size());
    }
    double extent = 0.0;
    for (const Eigen::Vector2d& point : ring) {
        if (!point.allFinite()) {
            return "has a corner that is not a number";
        }
        extent = std::max(extent, point.cwiseAbs().maxCoeff());
    }
    const WholeRing whole = to_whole(ring, exact_unit(extent));
    const std::size_t count = whole.size();
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = i + 2; j < count; ++j) {
            const bool neighbours = i == 0 && j + 1 == count;
            if (!neighbours &&
                cross_over(whole[i], whole[i + 1], whole[j], whole[(j + 1) % count])) {
                return fmt::format("crosses itself between corners {} and {}", i, j);
            }
        }
    }
    const Eigen::Vector2d size = bounds(ring).size();
    if (!(std::abs(signed_area(ring)) > 1e-9 * size.squaredNorm())) {
        return "has no area";
    }
    return {};
}

}  // namespace leafcutter::fab
