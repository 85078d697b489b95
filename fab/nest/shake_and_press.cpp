#include "fab/nest/shake_and_press.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// A trial that is not free of overlaps after a few rounds costs more than another one.
constexpr double kSlack = 0.03;          // Of the area, for a trial.
constexpr std::int64_t kRound = 25'000;  // Evaluations of separation before all parts move at once.
constexpr int kRounds = 6;
constexpr int kRelaxSteps = 16;
constexpr double kWorse = 0.004;     // Of the area, that may be lost at the beginning.
constexpr double kFarthest = 0.005;  // From the best.
constexpr std::size_t kMostLaidAnew = 4;
// Which of the two kinds of change yields more is learnt as the search goes on.
constexpr double kHalfForgotten = 500'000.0;  // Evaluations.
constexpr double kLeastShare = 0.05;          // Of the work, for either.
constexpr double kFirstShaken = 400'000.0;    // A poor start gains most by great changes.

}  // namespace

ShakeAndPress::ShakeAndPress(const BoardPlan& plan, const Packing& start, std::uint64_t seed)
    : plan_(plan),
      random_(seed),
      board_(plan),
      separation_(board_, random_),
      search_(board_, random_),
      relaxation_(board_),
      insertion_(plan, random_.bits()),
      swap_(plan),
      best_{start, area_taken(plan, start.extent), {}},
      current_(best_) {}

void ShakeAndPress::adopt(const Packing& better) {
    best_ = {better, area_taken(plan_, better.extent), {}};
    current_ = best_;
}

void ShakeAndPress::advance(std::int64_t evaluations,
                            double progress,
                            const std::stop_token& stop) {
    progress_ = progress;
    until_ += evaluations;
    while (this->evaluations() < until_) {
        if (stop.stop_requested()) {
            throw geometry::Cancelled();
        }
        if (current_.area > best_.area * (1.0 + kFarthest)) {
            current_ = best_;
        }
        const bool shakes = rounds_left_ > 0 || shakes_next();
        const double area = best_.area;
        const std::int64_t before = this->evaluations();
        if (!shakes) {
            insert();
        } else if (rounds_left_ > 0) {
            shake_on(stop);
        } else {
            begin_shaking();
        }
        (shakes ? shaking_ : inserting_)
            .add((area - best_.area) / area, static_cast<double>(this->evaluations() - before));
    }
}

void ShakeAndPress::Yield::add(double more_gain, double more_work) {
    const double kept = kHalfForgotten / (kHalfForgotten + more_work);
    gain = kept * gain + more_gain;
    work = kept * work + more_work;
    whole_work += more_work;
}

// Whatever yields more; but neither is ever given up.
bool ShakeAndPress::shakes_next() const {
    const double whole = shaking_.whole_work + inserting_.whole_work;
    if (shaking_.whole_work <= std::max(kFirstShaken, kLeastShare * whole)) {
        return true;
    }
    return inserting_.whole_work > kLeastShare * whole && shaking_.rate() >= inserting_.rate();
}

void ShakeAndPress::insert() {
    if (current_.settled.positions.empty()) {
        current_.settled = insertion_.settle(current_.packing);
    }
    const double worse = tolerance();
    if (auto found = insertion_.attempt(current_.settled, worse)) {
        const double area = area_taken(plan_, found->packing.extent);
        judge({std::move(found->packing), area, std::move(found->settled)}, worse);
    }
}

// Places spread with the sheet's edge as it makes room.
void ShakeAndPress::begin_shaking() {
    const bool swaps = !first_ && random_.below(2) == 0;
    std::vector<Position> positions = current_.packing.positions;
    if (swaps) {
        swap_.apply(positions, random_);
    }
    const Extent wider = extent_of_area(plan_, current_.area * (1.0 + kSlack));
    for (Position& at : positions) {
        if (wider.bins == current_.packing.extent.bins && at.bin + 1 == wider.bins) {
            at.x *= wider.last_width / current_.packing.extent.last_width;
        }
    }
    board_.restore(positions, wider);
    if (!swaps && !first_) {
        lay_anew();
    }
    first_ = false;
    separation_.begin({1, 30});
    rounds_left_ = kRounds;
    round_end_ = board_.evaluations() + kRound;
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

// Frees what was shaken of overlaps, until that is done or the work asked for is.
void ShakeAndPress::shake_on(const std::stop_token& stop) {
    const std::int64_t work_left = until_ - evaluations();
    const auto state =
        separation_.run(std::min(round_end_, board_.evaluations() + work_left), stop);
    if (state == Separation::State::Working && board_.evaluations() < round_end_) {
        return;
    }
    const std::vector<Position> before = board_.positions();
    if (state == Separation::State::Feasible || relaxation_.relax(kRelaxSteps)) {
        rounds_left_ = 0;
        press_shaken();
        return;
    }
    rounds_left_ = state == Separation::State::GaveUp ? 0 : rounds_left_ - 1;
    round_end_ = board_.evaluations() + kRound;
    for (std::size_t item = 0; item < before.size(); ++item) {
        board_.move(item, before[item]);
    }
}

void ShakeAndPress::press_shaken() {
    Packing found{board_.positions(), board_.extent()};
    relaxation_.settle();
    if (relaxation_.press()) {
        found = {board_.positions(), board_.extent()};
    }
    const double area = area_taken(plan_, found.extent);
    judge({std::move(found), area, {}}, tolerance());
}

// A share of the area; less and less as the search goes on.
double ShakeAndPress::tolerance() {
    return kWorse * std::max(0.0, 1.0 - progress_) * std::abs(random_.normal());
}

void ShakeAndPress::judge(Layout pressed, double worse) {
    const BoardPlan::Room& last =
        plan_.rooms[static_cast<std::size_t>(pressed.packing.extent.bins) - 1];
    if (pressed.packing.extent.last_width > last.width) {
        return;
    }
    if (pressed.area < best_.area) {
        best_ = pressed;
    }
    if (pressed.area < current_.area * (1.0 + worse)) {
        current_ = std::move(pressed);
    }
}

}  // namespace leafcutter::fab
