#include "fab/nest/pose_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "fab/nest/mate.h"

namespace leafcutter::fab {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// `position` turned by `by_deg` about a point of the part.
void turn_about(const Eigen::Vector2d& pivot, double by_deg, Position& position) {
    const double before = position.angle_deg * kDegree;
    position.angle_deg = std::remainder(position.angle_deg + by_deg, 360.0);
    const double after = position.angle_deg * kDegree;
    position.x += (std::cos(before) - std::cos(after)) * pivot.x() -
                  (std::sin(before) - std::sin(after)) * pivot.y();
    position.y += (std::sin(before) - std::sin(after)) * pivot.x() +
                  (std::cos(before) - std::cos(after)) * pivot.y();
}

// A part's smaller bounding side, by which steps are measured; of a bent band the band's width
// counts, since its bounds are far larger than what it takes.
double step_unit(const NestPart& part, const TurnedPart& shape) {
    const double side = std::min(shape.high_x - shape.low_x, shape.high_y - shape.low_y);
    return std::min(side, std::max(4.0 * part.width, 0.1 * side));
}

}  // namespace

float PoseSearch::loss_of(std::size_t item, const Position& position, float bound) {
    return board_.loss_at(item, board_.turned(item, position, scratch_), position, bound);
}

void PoseSearch::random_turn(const NestPart& part, Position& position) {
    if (part.turns_freely()) {
        position.turn = 0;
        position.angle_deg = part.allowed_deg.empty() ? random_.between(-180.0, 180.0)
                                                      : part.allowed_deg.at_share(random_.unit());
        return;
    }
    const std::size_t turn = random_.below(part.allowed_deg.size());
    position.turn = static_cast<int>(turn);
    position.angle_deg = part.allowed_deg[turn];
}

// Anywhere on the sheets, by their area. False if the part is too large for the sheet as it is
// turned.
bool PoseSearch::sample(std::size_t item, Position& position) {
    const int bins = board_.extent().bins;
    double area = 0.0;
    for (int bin = 0; bin < bins; ++bin) {
        area += board_.width_of(bin) * board_.height_of(bin);
    }
    double pick = random_.between(0.0, area);
    position.bin = 0;
    for (int bin = 0; bin + 1 < bins; ++bin) {
        pick -= board_.width_of(bin) * board_.height_of(bin);
        position.bin += pick >= 0.0 ? 1 : 0;
    }
    random_turn(board_.plan().part(item), position);
    const TurnedPart& shape = board_.turned(item, position, scratch_);
    const double x_play = board_.width_of(position.bin) - (shape.high_x - shape.low_x);
    const double y_play = board_.height_of(position.bin) - (shape.high_y - shape.low_y);
    if (x_play < 0.0 || y_play < 0.0) {
        return false;
    }
    position.x = random_.between(0.0, x_play) - shape.low_x;
    position.y = random_.between(0.0, y_play) - shape.low_y;
    return true;
}

void PoseSearch::sample_near(std::size_t item, const Position& around, Position& position) {
    const NestPart& part = board_.plan().part(item);
    const TurnedPart& shape = board_.shape(item);
    const double width = shape.high_x - shape.low_x;
    const double height = shape.high_y - shape.low_y;
    position = around;
    if (part.turns_freely()) {
        position.angle_deg = std::remainder(
            around.angle_deg + part.allowed_deg.step(around.angle_deg, 12.0 * random_.normal()),
            360.0);
    } else {
        random_turn(part, position);
    }
    position.x += random_.between(-0.5, 0.5) * width;
    position.y += random_.between(-0.5, 0.5) * height;
}

// About which a part turns: its origin, or else a point of a band, or the centre about which a
// bent band slides along itself.
Eigen::Vector2d PoseSearch::pivot(const NestPart& part) {
    if (!part.is_band()) {
        return Eigen::Vector2d::Zero();
    }
    switch (random_.below(3)) {
        case 0:
            return Eigen::Vector2d::Zero();
        case 1:
            return part.middle[random_.below(part.middle.size())].circle.centre;
        default:
            return part.bend_centre;
    }
}

void PoseSearch::keep(const Candidate& candidate) {
    for (std::size_t i = 0; i < kept_count_; ++i) {
        const Position& a = kept_[i].position;
        const Position& b = candidate.position;
        const bool same = a.bin == b.bin && std::abs(a.x - b.x) < apart_ &&
                          std::abs(a.y - b.y) < apart_ &&
                          std::abs(std::remainder(a.angle_deg - b.angle_deg, 360.0)) < 1.0;
        if (same) {
            if (candidate.loss < kept_[i].loss) {
                kept_[i] = candidate;
                std::sort(kept_, kept_ + kept_count_,
                          [](const Candidate& p, const Candidate& q) { return p.loss < q.loss; });
            }
            return;
        }
    }
    if (kept_count_ == kKept && candidate.loss >= kept_[kKept - 1].loss) {
        return;
    }
    std::size_t slot = kept_count_ < kKept ? kept_count_++ : kKept - 1;
    while (slot > 0 && kept_[slot - 1].loss > candidate.loss) {
        kept_[slot] = kept_[slot - 1];
        --slot;
    }
    kept_[slot] = candidate;
}

void PoseSearch::consider(std::size_t item, const Position& position) {
    const float bound = kept_count_ == kKept ? kept_[kKept - 1].loss : kInfinity;
    const auto loss = loss_of(item, position, bound);
    if (loss < bound) {
        keep({position, loss});
    }
}

PoseSearch::Axis PoseSearch::random_axis(const NestPart& part) {
    static constexpr std::array<std::array<double, 2>, 4> kDirections{
        {{1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}, {1.0, -1.0}}};
    if (part.turns_freely() && random_.below(3) == 0) {
        return {0.0, 0.0, true, pivot(part)};
    }
    const auto& [x, y] = kDirections[random_.below(kDirections.size())];
    return {x, y, false, Eigen::Vector2d::Zero()};
}

// Randomised coordinate descent; a step that fails shrinks, one that gains grows.
void PoseSearch::descend(std::size_t item, Candidate& candidate, const Steps& steps) {
    const NestPart& part = board_.plan().part(item);
    double step_x = steps.start;
    double step_y = steps.start;
    double step_turn = part.turns_freely() ? steps.turn_start_deg : 0.0;
    const auto step = [&](const Axis& axis, double sign) {
        Position to = candidate.position;
        to.x += sign * axis.x * step_x;
        to.y += sign * axis.y * step_y;
        if (axis.turn) {
            turn_about(axis.pivot, part.allowed_deg.step(to.angle_deg, sign * step_turn), to);
        }
        return to;
    };
    Axis axis = random_axis(part);
    while (candidate.loss > 0.0F &&
           (std::max(step_x, step_y) > steps.end || step_turn > steps.turn_end_deg)) {
        const Position ahead = step(axis, 1.0);
        const Position back = step(axis, -1.0);
        const float ahead_loss = loss_of(item, ahead, candidate.loss);
        const float bound = std::min(ahead_loss, candidate.loss);
        const float back_loss = bound > 0.0F ? loss_of(item, back, bound) : bound;
        const bool forward = ahead_loss <= back_loss;
        const bool better = std::min(ahead_loss, back_loss) < candidate.loss;
        if (better) {
            candidate = {forward ? ahead : back, forward ? ahead_loss : back_loss};
        }
        const double factor = better ? 1.1 : 0.5;
        const double shared = axis.x != 0.0 && axis.y != 0.0 ? std::sqrt(factor) : factor;
        step_turn *= axis.turn ? factor : 1.0;
        step_x *= axis.x != 0.0 ? shared : 1.0;
        step_y *= axis.y != 0.0 ? shared : 1.0;
        axis = better ? axis : random_axis(part);
    }
}

void PoseSearch::forget_kept(double unit) {
    apart_ = 0.05 * unit;
    kept_count_ = 0;
}

void PoseSearch::descend_kept(std::size_t item, double unit) {
    for (std::size_t i = 0; i < kept_count_; ++i) {
        descend(item, kept_[i], {0.25 * unit, 0.02 * unit, 5.0, 1.0});
    }
    std::stable_sort(kept_, kept_ + kept_count_,
                     [](const Candidate& a, const Candidate& b) { return a.loss < b.loss; });
}

Candidate PoseSearch::best_for(std::size_t item) {
    constexpr int kNear = 25;
    constexpr int kAnywhere = 50;
    constexpr int kMates = 30;
    const NestPart& part = board_.plan().part(item);
    const Position now = board_.position(item);
    const double unit = step_unit(part, board_.shape(item));
    forget_kept(unit);
    consider(item, now);
    Position position;
    for (int i = 0; i < kAnywhere; ++i) {
        if (sample(item, position)) {
            consider(item, position);
        }
    }
    for (int i = 0; i < kNear; ++i) {
        sample_near(item, now, position);
        consider(item, position);
    }
    if (part.is_band() && part.turns_freely()) {
        for (int i = 0; i < kMates; ++i) {
            if (const auto mate = random_mate(board_.plan(), item, random_)) {
                consider(item, mated(board_, *mate));
            }
        }
    }
    descend_kept(item, unit);
    Candidate best = kept_[0];
    descend(item, best, {0.01 * unit, 0.0003 * unit, 0.5, 0.02});
    return best;
}

std::vector<Candidate> PoseSearch::beside_others(std::size_t item,
                                                 int tries,
                                                 const Position& from) {
    constexpr int kMatched = 60;  // Stretches of others compared for one that is tried.
    constexpr int kAnywhere = 20;
    const NestPart& part = board_.plan().part(item);
    const double unit = step_unit(part, board_.shape(item));
    forget_kept(unit);
    const auto consider_elsewhere = [&](const Position& position) {
        if (!is_same_place(part, position, from)) {
            consider(item, position);
        }
    };
    for (int i = 0; i < tries; ++i) {
        if (const auto mate = best_mate(board_.plan(), item, kMatched, random_)) {
            consider_elsewhere(mated(board_, *mate));
        }
    }
    Position position;
    for (int i = 0; i < kAnywhere; ++i) {
        if (sample(item, position)) {
            consider_elsewhere(position);
        }
    }
    descend_kept(item, unit);
    std::vector<Candidate> found(kept_, kept_ + kept_count_);
    std::erase_if(found, [&](const Candidate& candidate) {
        return is_same_place(part, candidate.position, from);
    });
    return found;
}

Candidate PoseSearch::leftmost(std::size_t item, int samples) {
    const auto score = [&](const Position& at) {
        const TurnedPart& shape = board_.turned(item, at, scratch_);
        return 1e6 * at.bin + 10.0 * (2.0 * at.x + shape.low_x) + 2.0 * at.y + shape.low_y;
    };
    Candidate best{board_.position(item), kInfinity};
    double best_score = std::numeric_limits<double>::infinity();
    Position position;
    for (int i = 0; i < samples; ++i) {
        if (!sample(item, position)) {
            continue;
        }
        const double at = score(position);
        if (at < best_score && loss_of(item, position, kInfinity) <= 0.0F) {
            best = {position, 0.0F};
            best_score = at;
        }
    }
    if (best.loss > 0.0F) {
        return best;
    }
    // Pushed left and down as far as it goes.
    const double unit =
        step_unit(board_.plan().part(item), board_.turned(item, best.position, scratch_));
    static constexpr std::array<std::array<double, 2>, 3> kLeftAndDown{
        {{-1.0, 0.0}, {0.0, -1.0}, {-1.0, 1.0}}};
    for (double step = unit; step > 0.002 * unit;) {
        bool moved = false;
        for (const auto& [ax, ay] : kLeftAndDown) {
            Position next = best.position;
            next.x += ax * step;
            next.y += ay * step;
            if (loss_of(item, next, std::numeric_limits<float>::min()) <= 0.0F) {
                best.position = next;
                moved = true;
            }
        }
        step *= moved ? 1.0 : 0.5;
    }
    return best;
}

}  // namespace leafcutter::fab
