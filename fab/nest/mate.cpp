#include "fab/nest/mate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kPoints = 6;       // Of a stretch.
constexpr double kApart = 1.02;  // In halves of both widths.
constexpr double kRoughness =
    0.1;  // Of a width, added to a misfit: of two that fit the longer one.

double length_of(const NestPart& part) {
    return part.middle.back().from_start + part.middle.front().from_start;
}

// Points of a middle line at even steps.
class MiddleWalk {
public:
    MiddleWalk(const NestPart& part, double length) : part_(part), spacing_(length / count()) {}

    BandPoint at(double along) const {
        const double place = along / spacing_ - 0.5;
        const auto index = static_cast<std::size_t>(std::clamp(place + 0.5, 0.0, count() - 1.0));
        BandPoint point = part_.middle[index];
        point.circle.centre += (place - static_cast<double>(index)) * spacing_ * point.along;
        return point;
    }

private:
    double count() const { return static_cast<double>(part_.middle.size()); }

    const NestPart& part_;
    double spacing_;
};

double cross(const Vector2d& a, const Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// Which points go where, summed up for the least squares.
struct Match {
    Vector2d from = Vector2d::Zero();
    Vector2d to = Vector2d::Zero();
    double squares = 0.0;
    double dots = 0.0;
    double crosses = 0.0;

    void add(const Vector2d& p, const Vector2d& q) {
        from += p;
        to += q;
        squares += p.squaredNorm() + q.squaredNorm();
        dots += p.dot(q);
        crosses += cross(p, q);
    }

    // Umeyama, "Least-squares estimation of transformation parameters between two point patterns",
    // IEEE PAMI 13(4), 1991, in the plane.
    void fit(Mate& mate) const {
        mate.from = from / kPoints;
        mate.to = to / kPoints;
        const Vector2d turn(dots - kPoints * mate.from.dot(mate.to),
                            crosses - kPoints * cross(mate.from, mate.to));
        const double norm = turn.norm();
        mate.turn = norm > 0.0 ? Vector2d(turn / norm) : Vector2d::UnitX();
        const double left =
            squares - kPoints * (mate.from.squaredNorm() + mate.to.squaredNorm()) - 2.0 * norm;
        mate.misfit = std::sqrt(std::max(0.0, left) / kPoints);
    }
};

}  // namespace

std::optional<Mate> random_mate(const BoardPlan& plan, std::size_t item, Random& random) {
    Mate mate;
    mate.item = item;
    mate.other = random.below(plan.part_of.size());
    const NestPart& a = plan.part(item);
    const NestPart& b = plan.part(mate.other);
    if (mate.other == item || !b.is_band()) {
        return std::nullopt;
    }
    const double a_length = length_of(a);
    const double b_length = length_of(b);
    const bool backwards = random.below(2) == 1;
    const double side = random.below(2) == 1 ? kApart : -kApart;
    // Where the item's start lies along the other; at least a third of the shorter one overlaps.
    const double least = std::min(a_length, b_length) / 3.0;
    const double start = random.between(least - a_length, b_length - least);
    const double from = std::max(0.0, start);
    mate.overlap = std::min(b_length, start + a_length) - from;
    const MiddleWalk on_a(a, a_length);
    const MiddleWalk on_b(b, b_length);
    Match match;
    for (int i = 0; i < kPoints; ++i) {
        const double along = from + mate.overlap * (i + 0.5) / kPoints;
        const BandPoint p = on_a.at(backwards ? a_length - (along - start) : along - start);
        const BandPoint q = on_b.at(along);
        match.add(p.circle.centre, q.circle.centre + side * (p.circle.radius + q.circle.radius) *
                                                         Vector2d(-q.along.y(), q.along.x()));
    }
    match.fit(mate);
    return mate;
}

std::optional<Mate> best_mate(const BoardPlan& plan, std::size_t item, int tries, Random& random) {
    const double roughness = kRoughness * plan.part(item).width;
    const auto cost = [&](const Mate& mate) { return (mate.misfit + roughness) / mate.overlap; };
    std::optional<Mate> best;
    for (int i = 0; i < tries; ++i) {
        const std::optional<Mate> mate = random_mate(plan, item, random);
        if (mate && (!best || cost(*mate) < cost(*best))) {
            best = mate;
        }
    }
    return best;
}

bool is_same_place(const NestPart& band, const Position& one, const Position& other) {
    if (one.bin != other.bin) {
        return false;
    }
    // From the frame at `one` to that at `other`.
    const Eigen::Rotation2Dd back(-other.angle_deg * kDegree);
    const Eigen::Rotation2Dd turn((one.angle_deg - other.angle_deg) * kDegree);
    const Vector2d shift = back * Vector2d(one.x - other.x, one.y - other.y);
    const double near = band.width * band.width;
    std::size_t same = 0;
    for (const BandPoint& point : band.middle) {
        const Vector2d at = turn * point.circle.centre + shift;
        same += std::any_of(band.middle.begin(), band.middle.end(), [&](const BandPoint& b) {
            return (b.circle.centre - at).squaredNorm() < near;
        });
    }
    return 2 * same > band.middle.size();
}

Position mated(const Board& board, const Mate& mate) {
    const Position& there = board.position(mate.other);
    const NestPart& part = board.plan().part(mate.item);
    double turn = std::atan2(mate.turn.y(), mate.turn.x());
    Position position;
    position.bin = there.bin;
    position.angle_deg = std::remainder(turn / kDegree + there.angle_deg, 360.0);
    if (!part.allowed_deg.empty()) {
        position.angle_deg = part.allowed_deg.nearest(position.angle_deg);
        turn = (position.angle_deg - there.angle_deg) * kDegree;
    }
    // The item's origin in the other's frame, then on the sheet.
    const double c = std::cos(turn);
    const double s = std::sin(turn);
    const Vector2d at = mate.to - Vector2d(c * mate.from.x() - s * mate.from.y(),
                                           s * mate.from.x() + c * mate.from.y());
    const double along = std::cos(there.angle_deg * kDegree);
    const double up = std::sin(there.angle_deg * kDegree);
    position.x = there.x + along * at.x() - up * at.y();
    position.y = there.y + up * at.x() + along * at.y();
    return position;
}

}  // namespace leafcutter::fab
