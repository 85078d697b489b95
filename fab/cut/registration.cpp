#include "fab/cut/registration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "fab/clipper_paths.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;
using geometry::turn_of;

namespace {

using Eigen::Vector2d;

constexpr double kUnitsPerMm = 1e6;
constexpr int kMostSteps = 12;
constexpr double kStillRad = 1e-10;
constexpr double kStillMm = 1e-9;
constexpr std::size_t kWindow = 4;  // Edges to both sides of the last nearest one.

// A band this much longer than wide has a main direction.
constexpr double kElongated = 1.3;

struct Moments {
    double area = 0.0;
    Vector2d centre = Vector2d::Zero();
    double xx = 0.0;  // About the centre.
    double xy = 0.0;
    double yy = 0.0;
};

// Exact, by triangles from the first point.
Moments moments_of(const Ring& ring) {
    Moments sum;
    const Vector2d& origin = ring.front();
    for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
        const Vector2d a = ring[i] - origin;
        const Vector2d b = ring[i + 1] - origin;
        const double twice = turn_of(a, b);
        sum.area += twice / 2.0;
        sum.centre += twice / 6.0 * (a + b);
        sum.xx += twice / 12.0 * (a.x() * a.x() + a.x() * b.x() + b.x() * b.x());
        sum.yy += twice / 12.0 * (a.y() * a.y() + a.y() * b.y() + b.y() * b.y());
        sum.xy += twice / 24.0 *
                  (2.0 * a.x() * a.y() + 2.0 * b.x() * b.y() + a.x() * b.y() + b.x() * a.y());
    }
    const double area = std::abs(sum.area) > 0.0 ? sum.area : 1.0;
    const Vector2d centre = sum.centre / area;
    sum.xx = sum.xx / area - centre.x() * centre.x();
    sum.yy = sum.yy / area - centre.y() * centre.y();
    sum.xy = sum.xy / area - centre.x() * centre.y();
    sum.centre = origin + centre;
    return sum;
}

double main_direction(const Moments& moments) {
    return 0.5 * std::atan2(2.0 * moments.xy, moments.xx - moments.yy);
}

bool is_elongated(const Moments& moments) {
    const double mean = (moments.xx + moments.yy) / 2.0;
    const double spread = std::hypot((moments.xx - moments.yy) / 2.0, moments.xy);
    return mean + spread > kElongated * kElongated * (mean - spread);
}

struct Foot {
    Vector2d point;
    Vector2d normal = Vector2d::Zero();  // Of the edge, or towards the point if it is a corner.
    double square = std::numeric_limits<double>::infinity();
    std::size_t edge = 0;
};

void look_at_edge(const Ring& ring, std::size_t edge, const Vector2d& point, Foot& best) {
    const Vector2d& from = ring[edge];
    const Vector2d along = ring[(edge + 1) % ring.size()] - from;
    const double square = along.squaredNorm();
    const double t = square > 0.0 ? std::clamp((point - from).dot(along) / square, 0.0, 1.0) : 0.0;
    const Vector2d foot = from + t * along;
    const double distance = (point - foot).squaredNorm();
    if (distance < best.square) {
        best.point = foot;
        best.square = distance;
        best.edge = edge;
        best.normal = Vector2d(-along.y(), along.x()).stableNormalized();
    }
}

Foot foot_of(const Ring& ring, const Vector2d& point) {
    Foot best;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        look_at_edge(ring, i, point, best);
    }
    return best;
}

Foot foot_near(const Ring& ring, const Vector2d& point, std::size_t edge) {
    if (ring.size() <= 2 * kWindow + 1) {
        return foot_of(ring, point);
    }
    Foot best;
    for (std::size_t i = 0; i <= 2 * kWindow; ++i) {
        look_at_edge(ring, (edge + ring.size() + i - kWindow) % ring.size(), point, best);
    }
    return best;
}

Vector2d rotated(const Vector2d& point, double angle_rad) {
    return Eigen::Rotation2Dd(angle_rad) * point;
}

// One Gauss-Newton step of the sum of squared distances from the edges that the feet lie on.
Eigen::Vector3d step_towards(const std::vector<Vector2d>& points,
                             const std::vector<Foot>& feet,
                             const Vector2d& centre) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double square = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vector2d arm = points[i] - centre;
        const Vector2d& n = feet[i].normal;
        const Eigen::Vector3d row(turn_of(arm, n), n.x(), n.y());
        normal += row * row.transpose();
        right -= (points[i] - feet[i].point).dot(n) * row;
        square += arm.squaredNorm();
    }
    // A ring round which every normal is alike cannot be told along its edge.
    const auto count = static_cast<double>(points.size());
    normal.diagonal() += 1e-9 * Eigen::Vector3d(square + 1.0, count, count);
    return normal.ldlt().solve(right);
}

double largest_miss(const Ring& from, const Ring& to) {
    double square = 0.0;
    for (const Vector2d& point : from) {
        square = std::max(square, foot_of(to, point).square);
    }
    return std::sqrt(square);
}

Ring moved_by(const Ring& ring, const RigidMotion& motion) {
    Ring result;
    result.reserve(ring.size());
    for (const Vector2d& point : ring) {
        result.push_back(motion.apply(point));
    }
    return result;
}

RigidMotion refined(const Ring& contour, const Ring& planned, RigidMotion motion) {
    Ring points = moved_by(contour, motion);
    std::vector<Foot> feet;
    for (const Vector2d& point : points) {
        feet.push_back(foot_of(planned, point));
    }
    for (int step = 0; step < kMostSteps; ++step) {
        Vector2d centre = Vector2d::Zero();
        for (const Vector2d& point : points) {
            centre += point / static_cast<double>(points.size());
        }
        const Eigen::Vector3d change = step_towards(points, feet, centre);
        // p → R (p − centre) + centre + shift, after the motion so far.
        const Vector2d shift(change.y(), change.z());
        motion.shift = rotated(motion.shift - centre, change.x()) + centre + shift;
        motion.angle_rad += change.x();
        points = moved_by(contour, motion);
        for (std::size_t i = 0; i < points.size(); ++i) {
            feet[i] = foot_near(planned, points[i], feet[i].edge);
        }
        if (std::abs(change.x()) < kStillRad && shift.norm() < kStillMm) {
            break;
        }
    }
    return motion;
}

// The largest ring of what comes out, counter-clockwise.
Ring offset_ring(const Ring& ring, double by_mm) {
    const ClipperLib::Paths moved_paths =
        mitred_offset({upright_path(ring, kUnitsPerMm)}, by_mm * kUnitsPerMm);
    Ring result;
    double largest = 0.0;
    for (const ClipperLib::Path& contour : moved_paths) {
        const double area = std::abs(ClipperLib::Area(contour));
        if (area <= largest) {
            continue;
        }
        largest = area;
        result = ring_of(contour, kUnitsPerMm);
    }
    if (!result.empty() && signed_area(result) < 0.0) {
        std::reverse(result.begin(), result.end());
    }
    return result;
}

}  // namespace

Vector2d RigidMotion::apply(const Vector2d& point) const {
    return rotated(point, angle_rad) + shift;
}

Ring without_kerf(const Ring& ring, double kerf_mm) {
    return offset_ring(ring, -kerf_mm / 2.0);
}

Ring as_burnt(const Ring& outline, double kerf_mm) {
    return without_kerf(offset_ring(outline, kerf_mm / 2.0), kerf_mm);
}

Registration lay_onto(const Ring& contour,
                      const Ring& planned,
                      const std::vector<RigidMotion>& starts) {
    constexpr double kSurely = 0.01;  // mm: no other start does better in earnest.
    Registration best;
    best.miss_mm = std::numeric_limits<double>::infinity();
    for (const RigidMotion& start : starts) {
        Registration found;
        found.motion = refined(contour, planned, start);
        found.contour = moved_by(contour, found.motion);
        found.miss_mm =
            std::max(largest_miss(found.contour, planned), largest_miss(planned, found.contour));
        if (found.miss_mm < best.miss_mm) {
            best = std::move(found);
        }
        if (best.miss_mm < kSurely) {
            break;
        }
    }
    return best;
}

std::vector<RigidMotion> starts_by_shape(const Ring& contour, const Ring& planned) {
    const Moments from = moments_of(contour);
    const Moments to = moments_of(planned);
    const int ways = is_elongated(to) ? 2 : 16;
    std::vector<RigidMotion> starts;
    for (int i = 0; i < ways; ++i) {
        RigidMotion start;
        start.angle_rad = main_direction(to) - main_direction(from) +
                          2.0 * std::numbers::pi * static_cast<double>(i) / ways;
        start.shift = to.centre - rotated(from.centre, start.angle_rad);
        starts.push_back(start);
    }
    return starts;
}

ShapeKey shape_key(const Ring& ring) {
    const Moments moments = moments_of(ring);
    ShapeKey key;
    key.area_mm2 = std::abs(moments.area);
    key.spread_mm = std::sqrt(std::max(0.0, moments.xx + moments.yy));
    for (std::size_t i = 0; i < ring.size(); ++i) {
        key.perimeter_mm += (ring[(i + 1) % ring.size()] - ring[i]).norm();
    }
    return key;
}

Vector2d nearest_on(const Ring& ring, const Vector2d& point) {
    return foot_of(ring, point).point;
}

}  // namespace leafcutter::fab
