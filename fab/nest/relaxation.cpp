#include "fab/nest/relaxation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>

#include "fab/nest/nearest_edge.h"
#include "geometry/sparse_solver.h"

namespace leafcutter::fab {

namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Entries = std::vector<geometry::MatrixEntry>;

constexpr double kDegree = std::numbers::pi / 180.0;

// What lies nearer than this share of a part's width may come to touch in a step.
constexpr double kReach = 0.4;
constexpr double kDamping = 1e-3;  // So small that only the least of equal moves is meant.
constexpr int kNewtonSteps = 12;

// A vector's first derivative as it turns, along `normal`.
double lever(const Vector2d& arm, const Vector2d& normal) {
    return arm.x() * normal.y() - arm.y() * normal.x();
}

Vector3d gain(const Vector2d& normal, const Vector2d& arm, double turn) {
    return {normal.x(), normal.y(), lever(arm, normal) * turn};
}

void add_entry(Entries& lower, Index row, Index column, double value) {
    lower.push_back({static_cast<int>(row), static_cast<int>(column), value});
}

// What of the block lies in the lower triangle.
void add_block(Entries& lower, Index row, Index column, const Eigen::Matrix3d& block) {
    for (Index i = 0; i < 3; ++i) {
        for (Index j = 0; j < 3 && column + j <= row + i; ++j) {
            add_entry(lower, row + i, column + j, block(i, j));
        }
    }
}

}  // namespace

Relaxation::Relaxation(Board& board) : board_(board), turn_(board.items()) {
    double largest = 0.0;
    for (const BoardPlan::Room& room : board.plan().rooms) {
        largest = std::max(largest, room.height);
    }
    for (std::size_t item = 0; item < board.items(); ++item) {
        const NestPart& part = board.plan().part(item);
        turn_[item] = part.turns_freely() ? 4.0 / part.diameter : 0.0;
        trust_ += 0.25 * part.width / static_cast<double>(board.items());
        largest = std::max(largest, part.diameter);
    }
    clearance_ = 1e-6 * largest;  // Coordinates are floats.
}

bool Relaxation::relax(int steps) {
    constexpr int kPatience = 4;  // Steps in which the deepest overlap must become 20 % less.
    double before = 0.0;
    for (int step = 0;; ++step) {
        collect();
        const double now = deepest();
        if (now <= clearance_) {
            return board_.clashes().empty();
        }
        const bool counts = step % kPatience == 0;
        if (step == steps || (counts && step > kPatience && now > 0.8 * before)) {
            return false;
        }
        before = counts ? now : before;
        apply(solve());
    }
}

bool Relaxation::press() {
    constexpr int kSteps = 24;
    const double wide = board_.extent().last_width;
    // Under less and less of a push overlaps become smaller than what counts.
    for (const double push : {0.3, 0.03, 0.003}) {
        push_until_it_rests(push);
    }
    const double pressed = board_.extent().last_width;
    for (const double slack : {0.0, 2e-4, 1e-3, 4e-3}) {
        const double width = pressed * (1.0 + slack);
        board_.set_last_width(width);
        if (width < wide && relax(kSteps)) {
            return true;
        }
    }
    return false;
}

void Relaxation::push_until_it_rests(double push) {
    constexpr int kMost = 60;
    constexpr double kRest = 1e-4;
    push_ = push;
    int idle = 0;
    for (int step = 0; step < kMost && idle < 2; ++step) {
        const double before = board_.extent().last_width;
        collect();
        apply(solve());
        idle = board_.extent().last_width < before * (1.0 - kRest) ? 0 : idle + 1;
    }
    push_ = 0.0;
}

double Relaxation::reach(std::size_t item) const {
    return kReach * board_.plan().part(item).width;
}

double Relaxation::deepest() const {
    double most = 0.0;
    for (const Contact& contact : contacts_) {
        most = std::max(most, contact.want);
    }
    return most;
}

void Relaxation::collect() {
    contacts_.clear();
    for (std::size_t item = 0; item < board_.items(); ++item) {
        collect_walls(item);
        collect_fixed(item);
        for (std::size_t other = 0; other < board_.items(); ++other) {
            if (other != item && board_.position(other).bin == board_.position(item).bin) {
                collect_pair(item, other);
            }
        }
    }
    evaluations_ += static_cast<std::int64_t>(contacts_.size() / 4 + board_.items());
}

// Vertices of `item` against the outline of `other`.
void Relaxation::collect_pair(std::size_t item, std::size_t other) {
    const TurnedPart& part = board_.shape(item);
    const TurnedPart& outline = board_.shape(other);
    const double near = 0.5 * (reach(item) + reach(other));
    const Vector2d shift(board_.position(item).x - board_.position(other).x,
                         board_.position(item).y - board_.position(other).y);
    const Eigen::AlignedBox2d box(Vector2d(outline.low_x - near, outline.low_y - near),
                                  Vector2d(outline.high_x + near, outline.high_y + near));
    const Eigen::AlignedBox2d own(Vector2d(part.low_x, part.low_y) + shift,
                                  Vector2d(part.high_x, part.high_y) + shift);
    for (std::size_t i = 0; i < part.edges && box.intersects(own); ++i) {
        const Vector2d arm(part.x0[i], part.y0[i]);
        if (!box.contains(arm + shift)) {
            continue;
        }
        if (const std::optional<Foot> foot = foot_of(outline, arm + shift, near)) {
            contacts_.push_back({item, other, gain(foot->normal, arm, turn_[item]),
                                 -gain(foot->normal, foot->point, turn_[other]),
                                 2.0 * clearance_ - foot->distance});
        }
    }
}

void Relaxation::collect_fixed(std::size_t item) {
    const TurnedPart& part = board_.shape(item);
    const Vector2d shift(board_.position(item).x, board_.position(item).y);
    const double near = reach(item);
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

void Relaxation::collect_walls(std::size_t item) {
    const TurnedPart& part = board_.shape(item);
    const Position& at = board_.position(item);
    const Vector2d room(board_.width_of(at.bin), board_.height_of(at.bin));
    const Vector2d shift(at.x, at.y);
    const double near = reach(item);
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

// Rows of a move: x, y and turn of each item, then the edge's.
double Relaxation::short_by(const Contact& contact, const Vector& move) const {
    double left =
        contact.want - contact.item_gain.dot(move.segment<3>(static_cast<Index>(3 * contact.item)));
    if (contact.other < still()) {
        left -= contact.other_gain.dot(move.segment<3>(static_cast<Index>(3 * contact.other)));
    } else if (contact.other == edge()) {
        left -= move[move.size() - 1];
    }
    return left;
}

double Relaxation::energy(const Vector& move) const {
    const double edge_moves = move[move.size() - 1];
    double sum = kDamping * move.head(move.size() - 1).squaredNorm() +
                 push_ * edge_moves * (edge_moves / trust_ + 2.0);
    for (const Contact& contact : contacts_) {
        const double left = std::max(0.0, short_by(contact, move));
        sum += left * left;
    }
    return sum;
}

// Of the contacts of one pair, which lie in a row from `contact` on; moves on to the next pair.
Relaxation::Normal Relaxation::sum_up(std::size_t& contact, const Vector& move) const {
    const Contact& first = contacts_[contact];
    Normal sum;
    for (; contact < contacts_.size(); ++contact) {
        const Contact& next = contacts_[contact];
        if (next.item != first.item || next.other != first.other) {
            break;
        }
        if (short_by(next, move) <= 0.0) {
            continue;
        }
        sum.any = true;
        sum.item += next.item_gain * next.item_gain.transpose();
        sum.other += next.other_gain * next.other_gain.transpose();
        sum.mixed += next.item_gain * next.other_gain.transpose();
        sum.item_right += next.want * next.item_gain;
        sum.other_right += next.want * next.other_gain;
    }
    return sum;
}

// Where the energy is least if the contacts that are short of distance stay the same.
Relaxation::Vector Relaxation::newton(const Vector& move) const {
    const Index size = move.size();
    Entries entries;
    Vector right = Vector::Zero(size);
    for (Index i = 0; i + 1 < size; ++i) {
        add_entry(entries, i, i, kDamping);
    }
    add_entry(entries, size - 1, size - 1, push_ > 0.0 ? push_ / trust_ : 1.0);
    right[size - 1] = -push_;
    for (std::size_t k = 0; k < contacts_.size();) {
        const auto a = static_cast<Index>(3 * contacts_[k].item);
        const auto b = static_cast<Index>(3 * contacts_[k].other);
        const std::size_t other = contacts_[k].other;
        const Normal sum = sum_up(k, move);
        if (!sum.any) {
            continue;
        }
        add_block(entries, a, a, sum.item);
        right.segment<3>(a) += sum.item_right;
        if (other < still()) {
            add_block(entries, b, b, sum.other);
            add_block(entries, a, b, sum.mixed);
            add_block(entries, b, a, sum.mixed.transpose());
            right.segment<3>(b) += sum.other_right;
        } else if (other == edge() && push_ > 0.0) {
            add_entry(entries, size - 1, size - 1, sum.other(0, 0));
            right[size - 1] += sum.other_right.x();
            for (Index i = 0; i < 3; ++i) {
                add_entry(entries, size - 1, a + i, sum.mixed(i, 0));
            }
        }
    }
    // Eigen's factorisation gives the same bits whatever else is installed.
    return geometry::SparseSolver(static_cast<int>(size), entries, geometry::Factorization::Ldlt)
        .solve(right);
}

// The least move that gives every contact its distance, or comes nearest to that: a convex problem,
// quadratic but for which contacts count.
Relaxation::Vector Relaxation::solve() const {
    Vector move = Vector::Zero(static_cast<Index>(3 * board_.items() + 1));
    double now = energy(move);
    for (int step = 0; step < kNewtonSteps; ++step) {
        const Vector way = newton(move) - move;
        double share = 1.0;
        double next = energy(move + way);
        while (next > now && share > 0.01) {
            share *= 0.5;
            next = energy(move + share * way);
        }
        if (next >= now) {
            break;
        }
        move += share * way;
        const bool settled = next > 0.999 * now;
        now = next;
        if (settled) {
            break;
        }
    }
    return move;
}

// No part moves by more than half its width: what is linear holds no further.
void Relaxation::apply(const Vector& move) {
    if (push_ > 0.0) {
        board_.set_last_width(board_.extent().last_width +
                              std::clamp(move[move.size() - 1], -2.0 * trust_, 2.0 * trust_));
    }
    for (std::size_t item = 0; item < board_.items(); ++item) {
        const NestPart& part = board_.plan().part(item);
        const Vector3d by = move.segment<3>(static_cast<Index>(3 * item));
        // A unit of turn moves the ends of a part by two.
        const double most = by.head<2>().norm() + 2.0 * std::abs(by.z());
        if (most <= 0.0) {
            continue;
        }
        const double share = std::min(1.0, 0.5 * part.width / most);
        Position to = board_.position(item);
        to.x += share * by.x();
        to.y += share * by.y();
        if (part.turns_freely()) {
            const double turn_deg = share * by.z() * turn_[item] / kDegree;
            to.angle_deg =
                std::remainder(to.angle_deg + part.allowed_deg.step(to.angle_deg, turn_deg), 360.0);
        }
        board_.move(item, to);
    }
}

}  // namespace leafcutter::fab
