#include "fab/nest/part.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>

#include "fab/nest/collision.h"
#include "fab/nest/grow.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

namespace {

constexpr std::size_t kMostCircles = 32;
constexpr std::size_t kMostBandCircles = 48;
constexpr double kBandSlenderness = 6.0;
// Along a band as long as its diameter; a sliver has hardly any width.
constexpr double kMostPoints = 64.0;

// Far outside of everything, yet its square is a float.
constexpr float kNowhere = 1e15F;

double distance_to(const Ring& ring, const Eigen::Vector2d& point, Eigen::Vector2d& nearest) {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector2d& a = ring[i];
        const Eigen::Vector2d along = ring[i + 1 < ring.size() ? i + 1 : 0] - a;
        const double square = along.squaredNorm();
        const double t = square > 0.0 ? std::clamp((point - a).dot(along) / square, 0.0, 1.0) : 0.0;
        const Eigen::Vector2d foot = a + t * along;
        const double distance = (foot - point).squaredNorm();
        if (distance < best) {
            best = distance;
            nearest = foot;
        }
    }
    return std::sqrt(best);
}

// The largest circle inside the ring that touches it at `foot`: shrinks one until nothing of the
// ring is within (Ma, Bae and Choi, "3D medial axis point approximation using nearest neighbors and
// the normal field", The Visual Computer 28, 2012).
Circle touching_circle(const Ring& ring,
                       const Eigen::Vector2d& foot,
                       const Eigen::Vector2d& inward,
                       double largest,
                       Eigen::Vector2d& other) {
    constexpr int kMostSteps = 24;
    double radius = largest;
    Eigen::Vector2d nearest = foot;
    for (int step = 0; step < kMostSteps; ++step) {
        const double reached = distance_to(ring, foot + radius * inward, nearest);
        other = step == 0 || reached < radius * (1.0 - 1e-4) ? nearest : other;
        if (reached >= radius * (1.0 - 1e-4)) {
            break;
        }
        const Eigen::Vector2d chord = nearest - foot;
        const double rise = chord.dot(inward);
        if (rise <= 1e-12 * largest) {
            return {};
        }
        radius = std::min(0.9999 * radius, chord.squaredNorm() / (2.0 * rise));
    }
    const Eigen::Vector2d centre = foot + radius * inward;
    return {centre, contains(ring, centre) ? distance_to(ring, centre, nearest) : 0.0};
}

// A circle, and where along the ring it touches: at its foot and across from it.
struct Touch {
    Circle circle;
    double foot_at = 0.0;
    double other_at = 0.0;
};

// How far along the ring its point nearest to `point` is.
double place_on(const Ring& ring, const Eigen::Vector2d& point) {
    double best = std::numeric_limits<double>::infinity();
    double place = 0.0;
    double walked = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector2d along = ring[(i + 1) % ring.size()] - ring[i];
        const double length = along.norm();
        const double t =
            length > 0.0 ? std::clamp((point - ring[i]).dot(along) / (length * length), 0.0, 1.0)
                         : 0.0;
        const double distance = (ring[i] + t * along - point).squaredNorm();
        if (distance < best) {
            best = distance;
            place = walked + t * length;
        }
        walked += length;
    }
    return place;
}

// Circles that touch the ring, from feet spread evenly along it.
std::vector<Touch> touching_circles(const Ring& ring, double largest) {
    constexpr double kFeet = 240.0;
    double length = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        length += (ring[(i + 1) % ring.size()] - ring[i]).norm();
    }
    std::vector<Touch> touches;
    double walked = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector2d along = ring[(i + 1) % ring.size()] - ring[i];
        const double edge = along.norm();
        if (edge <= 0.0) {
            continue;
        }
        const Eigen::Vector2d inward(-along.y() / edge, along.x() / edge);
        const int feet = std::max(1, static_cast<int>(std::ceil(edge * kFeet / length)));
        for (int k = 0; k < feet; ++k) {
            const double share = (k + 0.5) / feet;
            const Eigen::Vector2d foot = ring[i] + along * share;
            Eigen::Vector2d other = foot;
            const Circle circle = touching_circle(ring, foot, inward, largest, other);
            if (circle.radius > 0.0) {
                touches.push_back({circle, walked + share * edge, place_on(ring, other)});
            }
        }
        walked += edge;
    }
    return touches;
}

std::size_t padded(std::size_t count) {
    return (count + TurnedPart::kLanes - 1) / TurnedPart::kLanes * TurnedPart::kLanes;
}

void fill_edges(const std::vector<float>& x, const std::vector<float>& y, TurnedPart& out) {
    const std::size_t count = x.size();
    const std::size_t size = padded(count);
    for (auto* array : {&out.x0, &out.y0, &out.x1, &out.y1}) {
        array->assign(size, kNowhere);
    }
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t next = i + 1 < count ? i + 1 : 0;
        out.x0[i] = x[i];
        out.y0[i] = y[i];
        out.x1[i] = x[next];
        out.y1[i] = y[next];
    }
    out.edges = count;
    out.blocks = size / TurnedPart::kLanes;
}

void fill_blocks(TurnedPart& out) {
    for (auto* array : {&out.block_x0, &out.block_y0, &out.block_x1, &out.block_y1}) {
        array->assign(padded(out.blocks), kNowhere);
    }
    for (std::size_t block = 0; block < out.blocks; ++block) {
        const std::size_t first = block * TurnedPart::kLanes;
        const std::size_t last = std::min(out.edges, first + TurnedPart::kLanes);
        float low_x = out.x1[last - 1];
        float low_y = out.y1[last - 1];
        float high_x = low_x;
        float high_y = low_y;
        for (std::size_t i = first; i < last; ++i) {
            low_x = std::min(low_x, out.x0[i]);
            low_y = std::min(low_y, out.y0[i]);
            high_x = std::max(high_x, out.x0[i]);
            high_y = std::max(high_y, out.y0[i]);
        }
        out.block_x0[block] = low_x;
        out.block_y0[block] = low_y;
        out.block_x1[block] = high_x;
        out.block_y1[block] = high_y;
    }
}

// Turned by the angle of cosine `c` and sine `s`.
void fill_circles(const NestPart& part, double c, double s, TurnedPart& out) {
    const std::size_t count = part.circles.size();
    const std::size_t size = padded(count);
    out.circles = count;
    out.band = part.is_band();
    out.width = static_cast<float>(part.width);
    out.circle_x.assign(size, kNowhere);
    out.circle_y.assign(size, kNowhere);
    for (auto* array : {&out.circle_r, &out.along_x, &out.along_y, &out.to_end}) {
        array->assign(size, 0.0F);
    }
    for (auto* array : {&out.group_x0, &out.group_y0}) {
        array->assign(size / TurnedPart::kLanes, kNowhere);
    }
    for (auto* array : {&out.group_x1, &out.group_y1}) {
        array->assign(size / TurnedPart::kLanes, -kNowhere);
    }
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Vector2d& p = part.circles[i].centre;
        const auto x = static_cast<float>(c * p.x() - s * p.y());
        const auto y = static_cast<float>(s * p.x() + c * p.y());
        const auto r = static_cast<float>(part.circles[i].radius);
        out.circle_x[i] = x;
        out.circle_y[i] = y;
        out.circle_r[i] = r;
        const std::size_t group = i / TurnedPart::kLanes;
        out.group_x0[group] = std::min(out.group_x0[group], x - r);
        out.group_y0[group] = std::min(out.group_y0[group], y - r);
        out.group_x1[group] = std::max(out.group_x1[group], x + r);
        out.group_y1[group] = std::max(out.group_y1[group], y + r);
        if (out.band) {
            const BandPoint& point = part.middle[i];
            const double whole = part.middle_length();
            out.along_x[i] = static_cast<float>(c * point.along.x() - s * point.along.y());
            out.along_y[i] = static_cast<float>(s * point.along.x() + c * point.along.y());
            out.to_end[i] =
                static_cast<float>(std::min(point.from_start, whole - point.from_start));
        }
    }
}

double largest_distance(const Ring& ring) {
    double square = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        for (std::size_t j = i + 1; j < ring.size(); ++j) {
            square = std::max(square, (ring[i] - ring[j]).squaredNorm());
        }
    }
    return std::sqrt(square);
}

// The centre of the circle nearest to a band's middle line, by linear least squares (Kåsa, "A
// circle fitting procedure and its error analysis", IEEE Trans. Instrum. Meas. 25, 1976); of nearly
// straight bands, a point far to the side.
Eigen::Vector2d bend_centre(const NestPart& part) {
    Eigen::MatrixXd rows(part.middle.size(), 3);
    Eigen::VectorXd squares(part.middle.size());
    for (std::size_t i = 0; i < part.middle.size(); ++i) {
        const Eigen::Vector2d& p = part.middle[i].circle.centre;
        const auto row = static_cast<Eigen::Index>(i);
        rows.row(row) << p.x(), p.y(), part.diameter;
        squares[row] = p.squaredNorm();
    }
    const Eigen::Matrix3d normal = rows.transpose() * rows + 1e-6 * part.diameter * part.diameter *
                                                                 Eigen::Matrix3d::Identity();
    const Eigen::Vector3d solution = normal.ldlt().solve(rows.transpose() * squares);
    return 0.5 * solution.head<2>();
}

}  // namespace

std::vector<Circle> inscribed_circles(const Ring& ring, std::size_t most) {
    const double area = std::abs(signed_area(ring));
    std::vector<Circle> pool;
    for (const Touch& touch : touching_circles(ring, std::sqrt(area / std::numbers::pi) * 1.01)) {
        pool.push_back(touch.circle);
    }
    std::vector<Circle> chosen;
    double covered = 0.0;
    const auto enough = [&] {
        return chosen.size() >= most || (chosen.size() >= 16 && covered > 0.8 * area) ||
               (chosen.size() >= 8 && covered > 0.9 * area);
    };
    // A circle of the pool shrinks as chosen ones come near.
    while (!enough()) {
        const auto best =
            std::max_element(pool.begin(), pool.end(),
                             [](const Circle& a, const Circle& b) { return a.radius < b.radius; });
        if (best == pool.end() || best->radius <= 0.0 ||
            (!chosen.empty() && best->radius < 0.02 * chosen.front().radius)) {
            break;
        }
        const Circle circle = *best;
        chosen.push_back(circle);
        covered += std::numbers::pi * circle.radius * circle.radius;
        for (Circle& other : pool) {
            other.radius =
                std::min(other.radius, (other.centre - circle.centre).norm() - circle.radius);
        }
    }
    return chosen;
}

std::vector<BandPoint> middle_line(const Ring& ring, std::size_t count) {
    const double area = std::abs(signed_area(ring));
    const std::vector<Touch> touches =
        touching_circles(ring, std::sqrt(area / std::numbers::pi) * 1.01);
    double length = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        length += (ring[(i + 1) % ring.size()] - ring[i]).norm();
    }
    // The feet of a circle lie opposite each other: as far from an end on either side. All agree on
    // the sum of the two, twice where the end is, up to the way around.
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const Touch& touch : touches) {
        const double turn = 2.0 * std::numbers::pi * (touch.foot_at + touch.other_at) / length;
        sum += Eigen::Vector2d(std::cos(turn), std::sin(turn));
    }
    const double end = std::atan2(sum.y(), sum.x()) / (2.0 * std::numbers::pi) * length / 2.0;
    std::vector<BandPoint> middle;
    for (std::size_t k = 0; k < count; ++k) {
        const double wanted = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
        const Touch* best = nullptr;
        double score = -std::numeric_limits<double>::infinity();
        for (const Touch& touch : touches) {
            const double at = std::abs(std::remainder(touch.foot_at - end, length)) * 2.0 / length;
            const double off = std::abs(at - wanted) * static_cast<double>(count);
            const double here = touch.circle.radius * (1.0 - std::min(off, 10.0) * 0.5);
            if (here > score) {
                score = here;
                best = &touch;
            }
        }
        if (best != nullptr) {
            BandPoint point;
            point.circle = best->circle;
            point.from_start = wanted * length / 2.0;
            middle.push_back(point);
        }
    }
    for (std::size_t k = 0; k < middle.size(); ++k) {
        const Circle& before = middle[k > 0 ? k - 1 : k].circle;
        const Circle& after = middle[k + 1 < middle.size() ? k + 1 : k].circle;
        const Eigen::Vector2d chord = after.centre - before.centre;
        middle[k].along =
            chord.norm() > 0.0 ? Eigen::Vector2d(chord.normalized()) : Eigen::Vector2d::UnitX();
    }
    return middle;
}

NestPart make_part(const Ring& outline, double grow, Rotations allowed_deg) {
    NestPart part;
    part.outline = grown(outline, grow);
    const NestShape shape = make_shape(part.outline);
    part.origin = shape.centroid;
    for (Eigen::Vector2d& point : part.outline) {
        point -= part.origin;
    }
    part.allowed_deg = std::move(allowed_deg);
    part.area = shape.area_mm2;
    part.width = shape.width_mm;
    part.diameter = largest_distance(part.outline);
    part.hull_area = std::abs(signed_area(convex_hull(part.outline)));
    if (part.diameter > kBandSlenderness * part.width) {
        const double length = part.area / part.width;
        const auto count = static_cast<std::size_t>(length / part.width);
        // Two bands that lie edge by edge then meet in vertices of both, not only at corners, where
        // no direction is that of the way apart.
        part.outline =
            subdivided(part.outline, std::max(2.0 * part.width, part.diameter / kMostPoints));
        part.middle =
            middle_line(part.outline, std::clamp<std::size_t>(count, 8, kMostBandCircles));
        for (const BandPoint& point : part.middle) {
            part.circles.push_back(point.circle);
        }
        part.bend_centre = bend_centre(part);
    } else {
        part.circles = inscribed_circles(part.outline, kMostCircles);
    }
    for (Circle& circle : part.circles) {
        circle.radius *= 1.0 - 1e-5;  // Two that touch must be two parts that overlap.
    }
    return part;
}

void turn_part(const NestPart& part, double angle_deg, TurnedPart& out) {
    // Quarter turns are exact.
    const double quarters = angle_deg / 90.0;
    const bool exact = quarters == std::round(quarters);
    const double c =
        exact ? std::round(std::cos(angle_deg * kDegree)) : std::cos(angle_deg * kDegree);
    const double s =
        exact ? std::round(std::sin(angle_deg * kDegree)) : std::sin(angle_deg * kDegree);
    static thread_local std::vector<float> x;
    static thread_local std::vector<float> y;
    x.resize(part.outline.size());
    y.resize(part.outline.size());
    for (std::size_t i = 0; i < part.outline.size(); ++i) {
        const Eigen::Vector2d& p = part.outline[i];
        x[i] = static_cast<float>(c * p.x() - s * p.y());
        y[i] = static_cast<float>(s * p.x() + c * p.y());
    }
    fill_edges(x, y, out);
    fill_blocks(out);
    out.low_x = *std::min_element(x.begin(), x.end());
    out.high_x = *std::max_element(x.begin(), x.end());
    out.low_y = *std::min_element(y.begin(), y.end());
    out.high_y = *std::max_element(y.begin(), y.end());
    fill_circles(part, c, s, out);
    out.diameter = static_cast<float>(part.diameter);
    out.hull_area = static_cast<float>(part.hull_area);
    out.hull_root = static_cast<float>(std::sqrt(std::sqrt(part.hull_area)));
}

void shift_part(TurnedPart& part, float dx, float dy) {
    for (auto* array : {&part.x0, &part.x1, &part.block_x0, &part.block_x1, &part.circle_x,
                        &part.group_x0, &part.group_x1}) {
        for (float& x : *array) {
            x += dx;
        }
    }
    for (auto* array : {&part.y0, &part.y1, &part.block_y0, &part.block_y1, &part.circle_y,
                        &part.group_y0, &part.group_y1}) {
        for (float& y : *array) {
            y += dy;
        }
    }
    part.low_x += dx;
    part.high_x += dx;
    part.low_y += dy;
    part.high_y += dy;
}

}  // namespace leafcutter::fab
