#include "fab/nest/separation.h"

#include <algorithm>
#include <limits>

#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

constexpr double kGain = 0.98;  // What counts as progress.

double total(const std::vector<PoseClash>& clashes) {
    double sum = 0.0;
    for (const PoseClash& clash : clashes) {
        sum += clash.loss;
    }
    return sum;
}

}  // namespace

void Separation::begin(const SeparationLimits& limits) {
    limits_ = limits;
    clashes_ = board_.clashes();
    best_ = board_.positions();
    best_loss_ = total(clashes_);
    round_loss_ = best_loss_;
    idle_ = 0;
    strikes_ = 0;
    line_up();
}

// The overlapping items in random order.
void Separation::line_up() {
    queue_.clear();
    for (const PoseClash& clash : clashes_) {
        queue_.push_back(clash.item);
        if (clash.other < board_.items()) {
            queue_.push_back(clash.other);
        }
    }
    std::sort(queue_.begin(), queue_.end());
    queue_.erase(std::unique(queue_.begin(), queue_.end()), queue_.end());
    random_.shuffle(queue_);
}

bool Separation::move_next(const std::stop_token& stop) {
    if (queue_.empty()) {
        return false;
    }
    if (stop.stop_requested()) {
        throw geometry::Cancelled();
    }
    const std::size_t item = queue_.back();
    queue_.pop_back();
    if (!board_.is_free(item)) {
        const Position to = search_.best_for(item).position;
        const Position& now = board_.position(item);
        if (to.x != now.x || to.y != now.y || to.angle_deg != now.angle_deg || to.bin != now.bin) {
            board_.move(item, to);
        }
    }
    return true;
}

Separation::State Separation::run(std::int64_t evaluations, const std::stop_token& stop) {
    State state = clashes_.empty() ? State::Feasible : State::Working;
    while (state == State::Working && board_.evaluations() < evaluations) {
        if (!move_next(stop)) {
            state = end_pass();
        }
    }
    return state;
}

Separation::State Separation::end_pass() {
    clashes_ = board_.clashes();
    const double loss = total(clashes_);
    ++idle_;
    if (loss < best_loss_) {
        idle_ = loss < kGain * best_loss_ ? 0 : idle_;
        best_loss_ = loss;
        best_ = board_.positions();
    }
    if (clashes_.empty()) {
        return State::Feasible;
    }
    board_.reweigh(clashes_);
    if (idle_ >= limits_.idle) {
        strikes_ = best_loss_ <= kGain * round_loss_ ? 0 : strikes_ + 1;
        if (strikes_ >= limits_.strikes) {
            return State::GaveUp;
        }
        round_loss_ = best_loss_;
        idle_ = 0;
        for (std::size_t item = 0; item < board_.items(); ++item) {
            board_.move(item, best_[item]);
        }
        clashes_ = board_.clashes();
    }
    line_up();
    return State::Working;
}

}  // namespace leafcutter::fab
