#include "fab/nest/contacts.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include "fab/nest/shape.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::turn_of;

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// What lies nearer than this share of a part's width may come to touch in a step.
constexpr double kReach = 0.4;
// What lies nearer than this share more is kept in mind.
constexpr double kMargin = 0.4;

Vector3d gain(const Vector2d& normal, const Vector2d& arm, double turn) {
    return {normal.x(), normal.y(), turn_of(arm, normal) * turn};
}

}  // namespace

Contacts::Contacts(const Board& board)
    : board_(board),
      turn_(board.items()),
      width_(board.items()),
      radius_(board.items()),
      outline_(board.items(), 1),
      neighbours_(board.items() * board.items()) {
    double largest = 0.0;
    for (const BoardPlan::Room& room : board.plan().rooms) {
        largest = std::max(largest, room.height);
    }
    for (std::size_t item = 0; item < board.items(); ++item) {
        const NestPart& part = board.plan().part(item);
        turn_[item] = part.turns_freely() ? 4.0 / part.diameter : 0.0;
        width_[item] = part.width;
        largest = std::max(largest, part.diameter);
        for (const Vector2d& point : part.outline) {
            radius_[item] = std::max(radius_[item], point.norm());
        }
    }
    clearance_ = 1e-6 * largest;  // Coordinates are floats.
}

Contacts::Lying Contacts::lying(std::size_t item) const {
    const Position& at = board_.position(item);
    const TurnedPart& shape = board_.shape(item);
    Lying out;
    out.shape = &shape;
    out.bin = at.bin;
    out.at = {at.x, at.y};
    out.low = out.at + Vector2d(shape.low_x, shape.low_y);
    out.high = out.at + Vector2d(shape.high_x, shape.high_y);
    out.along = {std::cos(at.angle_deg * kDegree), std::sin(at.angle_deg * kDegree)};
    out.angle_deg = at.angle_deg;
    return out;
}

const std::vector<Contact>& Contacts::find() {
    contacts_.clear();
    lying_.clear();
    for (std::size_t item = 0; item < board_.items(); ++item) {
        lying_.push_back(lying(item));
    }
    for (std::size_t item = 0; item < board_.items(); ++item) {
        add_walls(item);
        add_fixed(item);
        for (std::size_t other = 0; other < board_.items(); ++other) {
            if (may_touch(item, other)) {
                add_pair(item, other);
            }
        }
    }
    return contacts_;
}

bool Contacts::may_touch(std::size_t item, std::size_t other) const {
    const Lying& a = lying_[item];
    const Lying& b = lying_[other];
    const double reach = kReach * width(item, other);
    return item != other && a.bin == b.bin && a.low.x() <= b.high.x() + reach &&
           a.high.x() >= b.low.x() - reach && a.low.y() <= b.high.y() + reach &&
           a.high.y() >= b.low.y() - reach;
}

Contacts::Relative Contacts::relative(std::size_t item, std::size_t other) const {
    const Vector2d off = lying_[item].at - lying_[other].at;
    const Vector2d& along = lying_[other].along;
    return {{along.dot(off), turn_of(along, off)},
            lying_[item].angle_deg - lying_[other].angle_deg};
}

// Looked for anew only where one of the two has moved much, as seen from the other.
const std::vector<VertexBlock>& Contacts::near(std::size_t item, std::size_t other) {
    Neighbours& known = neighbours_[item * board_.items() + other];
    const Relative now = relative(item, other);
    const double turned = std::remainder(now.angle_deg - known.pose.angle_deg, 360.0) * kDegree;
    const double drift = (now.at - known.pose.at).norm() + radius_[item] * std::abs(turned);
    const double width = this->width(item, other);
    if (known.item_outline != outline_[item] || known.other_outline != outline_[other] ||
        drift > kMargin * width) {
        known.pose = now;
        known.item_outline = outline_[item];
        known.other_outline = outline_[other];
        near_blocks({*lying_[item].shape, *lying_[other].shape, lying_[item].at - lying_[other].at,
                     (kReach + kMargin) * width},
                    known.near);
    }
    return known.near;
}

// Vertices of `item` against the outline of `other`.
void Contacts::add_pair(std::size_t item, std::size_t other) {
    const TurnedPart& part = *lying_[item].shape;
    const Vector2d shift = lying_[item].at - lying_[other].at;
    feet_among({part, *lying_[other].shape, shift, kReach * width(item, other)}, near(item, other),
               feet_);
    for (const VertexFoot& at : feet_) {
        const Vector2d arm(part.x0[at.vertex], part.y0[at.vertex]);
        contacts_.push_back({item, other, gain(at.foot.normal, arm, turn_[item]),
                             -gain(at.foot.normal, at.foot.point, turn_[other]),
                             2.0 * clearance_ - at.foot.distance});
    }
}

void Contacts::add_fixed(std::size_t item) {
    const TurnedPart& part = board_.shape(item);
    const Vector2d shift(board_.position(item).x, board_.position(item).y);
    const double near = kReach * width_[item];
    for (const BoardPlan::Fixed& fixed : board_.plan().fixed) {
        if (fixed.bin != board_.position(item).bin ||
            !board_.plan().binds(fixed, board_.plan().part(item))) {
            continue;
        }
        for (std::size_t i = 0; i < part.edges; ++i) {
            const Vector2d arm(part.x0[i], part.y0[i]);
            if (const std::optional<Foot> foot = foot_of(fixed.shape, arm + shift, near)) {
                contacts_.push_back({item, still(), gain(foot->normal, arm, turn_[item]),
                                     Vector3d::Zero(), 2.0 * clearance_ - foot->distance});
            }
        }
        for (std::size_t i = 0; i < fixed.shape.edges; ++i) {
            const Vector2d corner(fixed.shape.x0[i], fixed.shape.y0[i]);
            if (const std::optional<Foot> foot = foot_of(part, corner - shift, near)) {
                contacts_.push_back({item, still(), -gain(foot->normal, foot->point, turn_[item]),
                                     Vector3d::Zero(), 2.0 * clearance_ - foot->distance});
            }
        }
    }
}

void Contacts::add_walls(std::size_t item) {
    const TurnedPart& part = board_.shape(item);
    const Position& at = board_.position(item);
    const Vector2d room(board_.width_of(at.bin), board_.height_of(at.bin));
    const Vector2d shift(at.x, at.y);
    const double near = kReach * width_[item];
    const bool moves = at.bin + 1 == board_.extent().bins;
    const Eigen::AlignedBox2d own(Vector2d(part.low_x, part.low_y) + shift,
                                  Vector2d(part.high_x, part.high_y) + shift);
    const auto wall = [&](const Vector2d& normal, double offset, std::size_t other) {
        for (std::size_t i = 0; i < part.edges; ++i) {
            const Vector2d arm(part.x0[i], part.y0[i]);
            const double distance = normal.dot(arm + shift) + offset;
            if (distance < near) {
                contacts_.push_back({item, other, gain(normal, arm, turn_[item]), Vector3d::UnitX(),
                                     2.0 * clearance_ - distance});
            }
        }
    };
    if (own.min().x() < near) {
        wall({1.0, 0.0}, 0.0, still());
    }
    if (own.max().x() > room.x() - near) {
        wall({-1.0, 0.0}, room.x(), moves ? edge() : still());
    }
    if (own.min().y() < near) {
        wall({0.0, 1.0}, 0.0, still());
    }
    if (own.max().y() > room.y() - near) {
        wall({0.0, -1.0}, room.y(), still());
    }
}

}  // namespace leafcutter::fab
