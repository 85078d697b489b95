// The smallest enclosing rectangle has a side along an edge of the convex hull: Freeman and
// Shapira, "Determining the minimum-area encasing rectangle for an arbitrary closed curve", CACM
// 18(7), 1975.

#include "fab/nest/shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;
using geometry::turn_of;

namespace {

double angle_of_deg(const Eigen::Vector2d& direction) {
    return std::atan2(direction.y(), direction.x()) / kDegree;
}

// Direction of largest variance of the area, as an angle.
double principal_axis_deg(const Ring& ring, const Eigen::Vector2d& centroid) {
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector2d a = ring[i] - centroid;
        const Eigen::Vector2d b = ring[(i + 1) % ring.size()] - centroid;
        const double w = turn_of(a, b);
        xx += w * (a.x() * a.x() + a.x() * b.x() + b.x() * b.x());
        yy += w * (a.y() * a.y() + a.y() * b.y() + b.y() * b.y());
        xy += w * (a.x() * b.y() + 2.0 * a.x() * a.y() + 2.0 * b.x() * b.y() + b.x() * a.y()) / 2.0;
    }
    const double sign = xx + yy < 0.0 ? -1.0 : 1.0;
    return 0.5 * std::atan2(2.0 * sign * xy, sign * (xx - yy)) / kDegree;
}

// The longer side of the smallest enclosing rectangle, as an angle.
double least_rectangle_deg(const Ring& hull) {
    double best_area = std::numeric_limits<double>::infinity();
    double best_deg = 0.0;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Eigen::Vector2d edge = hull[(i + 1) % hull.size()] - hull[i];
        if (edge.norm() <= 0.0) {
            continue;
        }
        const double angle_deg = angle_of_deg(edge);
        const Eigen::Vector2d size = bounds(moved(hull, {-angle_deg, {0.0, 0.0}})).size();
        if (size.x() * size.y() < best_area) {
            best_area = size.x() * size.y();
            best_deg = size.x() >= size.y() ? angle_deg : angle_deg + 90.0;
        }
    }
    return best_deg;
}

Eigen::Vector2d centroid_of(const Ring& ring, double area) {
    if (std::abs(area) <= 0.0) {
        return ring.front();
    }
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    const Eigen::Vector2d& base = ring.front();
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector2d a = ring[i] - base;
        const Eigen::Vector2d b = ring[(i + 1) % ring.size()] - base;
        sum += turn_of(a, b) * (a + b);
    }
    return base + sum / (6.0 * area);
}

bool fits(const Ring& hull, double angle_deg, const Eigen::Vector2d& extent) {
    const Eigen::Vector2d size = bounds(moved(hull, {angle_deg, {0.0, 0.0}})).size();
    return size.x() <= extent.x() && size.y() <= extent.y();
}

}  // namespace

// By Andrew's monotone chain.
Ring convex_hull(Ring points) {
    std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
        return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
    });
    Ring hull(2 * points.size());
    std::size_t size = 0;
    const auto add = [&](const Eigen::Vector2d& point, std::size_t floor) {
        while (size >= floor + 2 &&
               turn_of(hull[size - 1] - hull[size - 2], point - hull[size - 1]) <= 0.0) {
            --size;
        }
        hull[size++] = point;
    };
    for (const Eigen::Vector2d& point : points) {
        add(point, 0);
    }
    const std::size_t upper = size - 1;
    for (std::size_t i = points.size() - 1; i-- > 0;) {
        add(points[i], upper);
    }
    hull.resize(size > 1 ? size - 1 : size);
    return hull;
}

Box bounds(std::span<const Eigen::Vector2d> points) {
    Box box{points.front(), points.front()};
    for (const Eigen::Vector2d& point : points) {
        box.low = box.low.cwiseMin(point);
        box.high = box.high.cwiseMax(point);
    }
    return box;
}

Ring moved(const Ring& ring, const Pose& pose) {
    const double c = std::cos(pose.angle_deg * kDegree);
    const double s = std::sin(pose.angle_deg * kDegree);
    Ring out;
    out.reserve(ring.size());
    for (const Eigen::Vector2d& p : ring) {
        out.emplace_back(c * p.x() - s * p.y() + pose.offset.x(),
                         s * p.x() + c * p.y() + pose.offset.y());
    }
    return out;
}

NestShape make_shape(const Ring& outline) {
    NestShape shape;
    shape.outline = outline;
    const double area = signed_area(outline);
    shape.area_mm2 = std::abs(area);
    shape.centroid = centroid_of(outline, area);
    double perimeter = 0.0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        perimeter += (outline[(i + 1) % outline.size()] - outline[i]).norm();
    }
    shape.width_mm = perimeter > 0.0 ? 2.0 * shape.area_mm2 / perimeter : 0.0;
    const Ring hull = convex_hull(outline);
    for (const Eigen::Vector2d& a : hull) {
        for (const Eigen::Vector2d& b : hull) {
            shape.diameter_mm = std::max(shape.diameter_mm, (a - b).norm());
        }
    }
    shape.lying_deg = {-principal_axis_deg(outline, shape.centroid), -least_rectangle_deg(hull)};
    return shape;
}

Ring subdivided(const Ring& ring, double longest) {
    Ring out;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector2d along = ring[(i + 1) % ring.size()] - ring[i];
        const auto parts = static_cast<int>(std::max(1.0, std::ceil(along.norm() / longest)));
        for (int k = 0; k < parts; ++k) {
            out.emplace_back(ring[i] + static_cast<double>(k) / parts * along);
        }
    }
    return out;
}

std::optional<double> fitting_angle(const NestShape& shape,
                                    const Eigen::Vector2d& extent,
                                    const Rotations& allowed_deg) {
    const Ring hull = convex_hull(shape.outline);
    for (const double angle_deg : allowed_deg.samples()) {
        if (fits(hull, angle_deg, extent)) {
            return angle_deg;
        }
    }
    if (!allowed_deg.empty()) {
        return std::nullopt;
    }
    for (const double lying_deg : shape.lying_deg) {
        for (const double turn_deg : {0.0, 90.0}) {
            if (fits(hull, lying_deg + turn_deg, extent)) {
                return lying_deg + turn_deg;
            }
        }
    }
    // A slanted long piece may fit where it fits along no axis.
    constexpr double kStepDeg = 0.25;
    for (double angle_deg = 0.0; angle_deg < 180.0; angle_deg += kStepDeg) {
        if (fits(hull, angle_deg, extent)) {
            return angle_deg;
        }
    }
    return std::nullopt;
}

}  // namespace leafcutter::fab
