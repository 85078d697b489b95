#include "drivers/sim/motion_queue.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace leafcutter::drivers {

namespace {

constexpr double kTinyMm = 1e-9;  // Rest of a block that counts as none: far below one step.
constexpr double kTinySpeed = 1e-9;

double dot(const Axes& a, const Axes& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// The largest value along a unit direction that no axis's own limit forbids.
double along(const Axes& limits, const Axes& unit) {
    double least = std::numeric_limits<double>::max();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (unit[axis] != 0.0) {
            least = std::min(least, limits[axis] / std::abs(unit[axis]));
        }
    }
    return least;
}

double square(double value) {
    return value * value;
}

}  // namespace

// Grbl 1.1 spindle_control.c, spindle_compute_pwm_value().
double MotionOverrides::put_out(double s) const {
    const double wanted = s * power;
    if (least_s >= most_s || wanted >= most_s) {
        return most_s;
    }
    return wanted > 0.0 ? std::max(wanted, least_s) : 0.0;
}

double MotionQueue::nominal(const Block& block) const {
    if (block.move.rapid) {
        return block.top_mm_per_s * overrides_.rapid;
    }
    return std::min(block.top_mm_per_s, block.programmed_mm_per_s * overrides_.feed);
}

// Grbl 1.1 planner.c, plan_buffer_line(): junction deviation.
double MotionQueue::corner_speed(const Block& before,
                                 const Block& after,
                                 const MotionLimits& limits) const {
    const double cos_theta = -dot(before.unit, after.unit);
    if (cos_theta > 0.999999) {
        return 0.0;
    }
    if (cos_theta < -0.999999) {
        return std::numeric_limits<double>::max();
    }
    Axes bisector{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        bisector[axis] = after.unit[axis] - before.unit[axis];
    }
    const double length = std::sqrt(dot(bisector, bisector));
    for (double& part : bisector) {
        part /= length;
    }
    const double sin_half = std::sqrt(0.5 * (1.0 - cos_theta));
    const double acceleration = along(limits.acceleration, bisector);
    return std::sqrt(acceleration * limits.junction_deviation_mm * sin_half / (1.0 - sin_half));
}

bool MotionQueue::push(const Move& move, const MotionLimits& limits) {
    assert(!full());
    Block block;
    block.move = move;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        block.unit[axis] = move.target_mm[axis] - end_mm_[axis];
    }
    block.length_mm = block.left_mm = std::sqrt(dot(block.unit, block.unit));
    if (block.length_mm < kTinyMm) {
        return false;
    }
    for (double& part : block.unit) {
        part /= block.length_mm;
    }
    block.top_mm_per_s = along(limits.max_mm_per_s, block.unit);
    block.acceleration = along(limits.acceleration, block.unit);
    block.programmed_mm_per_s =
        move.rapid ? block.top_mm_per_s : std::max(move.feed_mm_per_min / 60.0, 1e-3);
    block.junction_speed = blocks_.empty() ? 0.0 : corner_speed(blocks_.back(), block, limits);
    blocks_.push_back(block);
    end_mm_ = move.target_mm;
    plan();
    return true;
}

void MotionQueue::set_overrides(const MotionOverrides& overrides, double now_s, BeamLog& log) {
    end_piece(now_s, log);  // A change of power starts a piece of its own.
    overrides_ = overrides;
    plan();
}

// Backward: every block may still stop at the queue's end. Forward: none is entered faster than the
// one before can reach.
void MotionQueue::plan() {
    double exit_speed = 0.0;
    for (std::size_t i = blocks_.size(); i-- > 1;) {
        Block& block = blocks_[i];
        const double most =
            std::min({block.junction_speed, nominal(block), nominal(blocks_[i - 1])});
        block.entry_speed = std::min(
            most, std::sqrt(square(exit_speed) + 2.0 * block.acceleration * block.length_mm));
        exit_speed = block.entry_speed;
    }
    double entry_speed = speed_;
    for (std::size_t i = 0; i + 1 < blocks_.size(); ++i) {
        const double reached =
            std::sqrt(square(entry_speed) + 2.0 * blocks_[i].acceleration * blocks_[i].left_mm);
        entry_speed = blocks_[i + 1].entry_speed = std::min(blocks_[i + 1].entry_speed, reached);
    }
}

void MotionQueue::hold() {
    holding_ = true;
}

void MotionQueue::release() {
    holding_ = false;
    plan();
}

MotionQueue::Phase MotionQueue::next_phase() const {
    const Block& block = blocks_.front();
    const double a = block.acceleration;
    const double left = block.left_mm;
    const double v2 = square(speed_);
    const double end_if_braking = std::sqrt(std::max(0.0, v2 - 2.0 * a * left));
    if (holding_) {
        const double stop_mm = v2 / (2.0 * a);
        return stop_mm <= left ? Phase{-a, stop_mm, 0.0} : Phase{-a, left, end_if_braking};
    }
    const double exit_speed = blocks_.size() > 1 ? blocks_[1].entry_speed : 0.0;
    const double brake_mm = (v2 - square(exit_speed)) / (2.0 * a);
    if (speed_ > exit_speed && left <= brake_mm + kTinyMm) {
        return {-a, left, end_if_braking};
    }
    const double top = nominal(block);
    if (speed_ > top + kTinySpeed) {
        const double slow_mm = (v2 - square(top)) / (2.0 * a);
        return slow_mm < left ? Phase{-a, slow_mm, top} : Phase{-a, left, end_if_braking};
    }
    if (speed_ < top - kTinySpeed) {
        const double meeting = std::sqrt((2.0 * a * left + v2 + square(exit_speed)) / 2.0);
        const double reached = std::min(top, meeting);
        return {a, std::clamp((square(reached) - v2) / (2.0 * a), 0.0, left), reached};
    }
    return {0.0, std::max(0.0, left - std::max(0.0, brake_mm)), speed_};
}

// Returns the time used, `budget_s` at most.
double MotionQueue::run_phase(const Phase& phase, double budget_s) {
    Block& block = blocks_.front();
    const double sum = speed_ + phase.end_speed;
    const double whole_s = sum > 0.0 ? 2.0 * phase.length_mm / sum : 0.0;
    if (whole_s <= budget_s) {
        block.left_mm -= phase.length_mm;
        speed_ = phase.end_speed;
    } else {
        block.left_mm -= speed_ * budget_s + 0.5 * phase.acceleration * square(budget_s);
        speed_ = std::max(0.0, speed_ + phase.acceleration * budget_s);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        position_mm_[axis] = block.move.target_mm[axis] - block.unit[axis] * block.left_mm;
    }
    return std::min(whole_s, budget_s);
}

double MotionQueue::advance(double seconds, double now_s, BeamLog& log) {
    double used = 0.0;
    while (used < seconds && !standing()) {
        if (!piece_) {
            begin_piece(now_s);
        }
        used += run_phase(next_phase(), seconds - used);
        if (blocks_.front().left_mm <= kTinyMm) {
            position_mm_ = blocks_.front().move.target_mm;
            end_piece(now_s + used, log);
            blocks_.pop_front();
            speed_ = blocks_.empty() ? 0.0 : speed_;
            break;
        }
        if (holding_ && speed_ <= kTinySpeed) {
            speed_ = 0.0;
            end_piece(now_s + used, log);
        }
    }
    return used;
}

void MotionQueue::clear(double now_s, BeamLog& log) {
    end_piece(now_s, log);
    blocks_.clear();
    end_mm_ = position_mm_;
    speed_ = 0.0;
    holding_ = false;
}

std::optional<double> MotionQueue::running_power() const {
    if (blocks_.empty() || standing()) {
        return std::nullopt;
    }
    const Block& block = blocks_.front();
    if (block.move.beam == BeamMode::Off) {
        return 0.0;
    }
    const double scale = block.move.scale_power ? speed_ / block.programmed_mm_per_s : 1.0;
    return overrides_.put_out(block.move.power_s * scale);
}

void MotionQueue::begin_piece(double now_s) {
    const Move& move = blocks_.front().move;
    piece_ = BurntPiece{};
    piece_->t0_s = now_s;
    piece_->x0_mm = position_mm_[0] - move.work_offset_mm[0];
    piece_->y0_mm = position_mm_[1] - move.work_offset_mm[1];
}

void MotionQueue::end_piece(double now_s, BeamLog& log) {
    if (!piece_) {
        return;
    }
    const Block& block = blocks_.front();
    BurntPiece piece = *piece_;
    piece_.reset();
    if (block.move.beam == BeamMode::Off || block.move.power_s <= 0.0) {
        return;
    }
    piece.t1_s = now_s;
    piece.x1_mm = position_mm_[0] - block.move.work_offset_mm[0];
    piece.y1_mm = position_mm_[1] - block.move.work_offset_mm[1];
    piece.s = overrides_.put_out(block.move.power_s);
    piece.feed_mm_per_min = block.programmed_mm_per_s * 60.0;
    piece.s_mean = piece.s;
    const double seconds = piece.t1_s - piece.t0_s;
    if (block.move.scale_power && seconds > 0.0) {
        const double mm = std::hypot(piece.x1_mm - piece.x0_mm, piece.y1_mm - piece.y0_mm);
        piece.s_mean = piece.s * mm / seconds / block.programmed_mm_per_s;
    }
    log.add(piece);
}

}  // namespace leafcutter::drivers
