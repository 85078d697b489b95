#include "fab/nest/shake_and_press.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// A trial that is not free of overlaps after a few rounds costs more than another one.
constexpr double kSlack = 0.03;          // Of the area, for a trial.
constexpr std::int64_t kRound = 25'000;  // Evaluations of separation before all parts move at once.
constexpr int kRounds = 6;
constexpr int kRelaxSteps = 16;
constexpr double kWorse = 0.004;    // Of the area, that may be lost at the beginning.
constexpr double kFarthest = 0.01;  // From the best.
constexpr std::size_t kMostLaidAnew = 4;

}  // namespace

ShakeAndPress::ShakeAndPress(const BoardPlan& plan, const Packing& start, std::uint64_t seed)
    : plan_(plan),
      random_(seed),
      board_(plan),
      separation_(board_, random_),
      search_(board_, random_),
      relaxation_(board_),
      swap_(plan),
      best_(start),
      current_(start),
      best_area_(area_taken(plan, start.extent)),
      current_area_(best_area_) {}

void ShakeAndPress::adopt(const Packing& better) {
    best_ = better;
    best_area_ = area_taken(plan_, better.extent);
    current_ = best_;
    current_area_ = best_area_;
}

void ShakeAndPress::advance(std::int64_t evaluations,
                            double progress,
                            const std::stop_token& stop) {
    progress_ = progress;
    const std::int64_t until = this->evaluations() + evaluations;
    while (this->evaluations() < until) {
        if (!working_) {
            begin_trial();
        }
        if (is_freed(stop)) {
            press();
        }
    }
}

// Places spread with the sheet's edge as it makes room.
void ShakeAndPress::begin_trial() {
    if (current_area_ > best_area_ * (1.0 + kFarthest)) {
        current_ = best_;
        current_area_ = best_area_;
    }
    working_ = true;
    rounds_ = 0;
    const bool swaps = !first_ && random_.below(2) == 0;
    std::vector<Position> positions = current_.positions;
    if (swaps) {
        swap_.apply(positions, random_);
    }
    const Extent wider = extent_of_area(plan_, current_area_ * (1.0 + kSlack));
    for (Position& at : positions) {
        if (wider.bins == current_.extent.bins && at.bin + 1 == wider.bins) {
            at.x *= wider.last_width / current_.extent.last_width;
        }
    }
    board_.restore(positions, wider);
    if (!swaps && !first_) {
        lay_anew();
    }
    first_ = false;
    separation_.begin({1, 30});
}

// A part and some of those near it, one after the other where it overlaps least.
void ShakeAndPress::lay_anew() {
    const Position around = board_.position(random_.below(board_.items()));
    const std::size_t count = 1 + random_.below(std::min(kMostLaidAnew, board_.items()));
    std::vector<double> distance;
    for (const Position& at : board_.positions()) {
        const double apart = at.bin == around.bin ? 0.0 : 1e6;
        distance.push_back((std::hypot(at.x - around.x, at.y - around.y) + apart) *
                           random_.between(0.5, 1.5));
    }
    std::vector<std::size_t> order(board_.items());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return distance[a] != distance[b] ? distance[a] < distance[b] : a < b;
    });
    order.resize(count);
    random_.shuffle(order);
    constexpr double kOutOfTheWay = -1e5;
    for (const std::size_t item : order) {
        Position away = board_.position(item);
        away.x = kOutOfTheWay;
        board_.move(item, away);
    }
    for (const std::size_t item : order) {
        board_.move(item, search_.best_for(item).position);
    }
}

// One round of the trial. Gives the trial up after the last one.
bool ShakeAndPress::is_freed(const std::stop_token& stop) {
    const auto state = separation_.run(board_.evaluations() + kRound, stop);
    if (stop.stop_requested()) {
        throw geometry::Cancelled();
    }
    if (state == Separation::State::Feasible) {
        return true;
    }
    const std::vector<Position> before = board_.positions();
    if (relaxation_.relax(kRelaxSteps)) {
        return true;
    }
    for (std::size_t item = 0; item < before.size(); ++item) {
        board_.move(item, before[item]);
    }
    working_ = ++rounds_ < kRounds && state == Separation::State::Working;
    return false;
}

void ShakeAndPress::press() {
    working_ = false;
    Packing found{board_.positions(), board_.extent()};
    if (relaxation_.press()) {
        found = {board_.positions(), board_.extent()};
    }
    judge(found);
}

void ShakeAndPress::judge(const Packing& pressed) {
    const double area = area_taken(plan_, pressed.extent);
    const double worse = kWorse * std::max(0.0, 1.0 - progress_) * std::abs(random_.normal());
    if (area < current_area_ * (1.0 + worse)) {
        current_ = pressed;
        current_area_ = area;
    }
    if (area < best_area_) {
        best_ = pressed;
        best_area_ = area;
    }
}

}  // namespace leafcutter::fab
