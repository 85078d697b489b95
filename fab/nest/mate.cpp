#include "fab/nest/mate.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "fab/point_pairs.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr int kPoints = 6;       // Of a stretch.
constexpr double kApart = 1.02;  // In halves of both widths.
// Of a width, added to a misfit: of two that fit the longer one.
constexpr double kRoughness = 0.1;

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

// Without a change of size.
void fit(const PointPairs& pairs, Mate& mate) {
    mate.from = pairs.from();
    mate.to = pairs.to();
    const Vector2d turn = pairs.products();
    const double norm = turn.norm();
    mate.turn = norm > 0.0 ? Vector2d(turn / norm) : Vector2d::UnitX();
    const double left = pairs.from_squares() + pairs.to_squares() - 2.0 * norm;
    mate.misfit = std::sqrt(std::max(0.0, left) / pairs.count());
}

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
    const double a_length = a.middle_length();
    const double b_length = b.middle_length();
    const bool backwards = random.below(2) == 1;
    const double side = random.below(2) == 1 ? kApart : -kApart;
    // Where the item's start lies along the other; at least a third of the shorter one overlaps.
    const double least = std::min(a_length, b_length) / 3.0;
    const double start = random.between(least - a_length, b_length - least);
    const double from = std::max(0.0, start);
    mate.overlap = std::min(b_length, start + a_length) - from;
    const MiddleWalk on_a(a, a_length);
    const MiddleWalk on_b(b, b_length);
    PointPairs pairs;
    for (int i = 0; i < kPoints; ++i) {
        const double along = from + mate.overlap * (i + 0.5) / kPoints;
        const BandPoint p = on_a.at(backwards ? a_length - (along - start) : along - start);
        const BandPoint q = on_b.at(along);
        pairs.add(p.circle.centre, q.circle.centre + side * (p.circle.radius + q.circle.radius) *
                                                         Vector2d(-q.along.y(), q.along.x()));
    }
    fit(pairs, mate);
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
    const Vector2d origin = mate.to - Eigen::Rotation2Dd(turn) * mate.from;
    const Vector2d at = Eigen::Rotation2Dd(there.angle_deg * kDegree) * origin;
    position.x = there.x + at.x();
    position.y = there.y + at.y();
    return position;
}

}  // namespace leafcutter::fab
