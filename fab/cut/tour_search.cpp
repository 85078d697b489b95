// 2-opt and Or-opt over neighbour lists with a queue of places to look at (Bentley, "Fast
// Algorithms for Geometric Traveling Salesman Problems", ORSA J. Computing 1992, section 4:
// don't-look bits), and Or-3opt kicks: two neighbouring short runs change places (Martin, Otto and
// Felten 1992, its local form), taken back unless the tour becomes no longer.

#include "fab/cut/tour_search.h"

#include <algorithm>
#include <cmath>

namespace leafcutter::fab {

namespace {

constexpr double kGainMm = 1e-6;  // Less is no improvement, or rounding would go round in circles.
constexpr std::size_t kLongestRun = 3;    // That Or-opt moves.
constexpr std::size_t kLongestKick = 40;  // Of each of the runs that change places.

// Starts of a closed place are looked at in steps, then round the best.
constexpr std::size_t kStride = 5;

std::ptrdiff_t offset(std::size_t i) {
    return static_cast<std::ptrdiff_t>(i);
}

}  // namespace

TourSearch::TourSearch(const TourProblem& problem,
                       const std::vector<std::vector<std::size_t>>& neighbours,
                       std::vector<TourStop> tour,
                       const geometry::Context& context)
    : problem_(problem),
      neighbours_(neighbours),
      context_(context),
      position_(tour.size()),
      start_(tour.size()),
      entry_(tour.size()),
      exit_(tour.size()),
      queued_(tour.size(), 0) {
    if (!problem.before.empty()) {
        earlier_.resize(tour.size());
        later_.resize(tour.size());
        for (const auto& [first, second] : problem.before) {
            earlier_[second].push_back(first);
            later_[first].push_back(second);
        }
    }
    for (const TourStop& stop : tour) {
        position_[stop.stop] = order_.size();
        order_.push_back(stop.stop);
    }
    set_starts(tour);
}

void TourSearch::set_starts(const std::vector<TourStop>& tour) {
    for (const TourStop& stop : tour) {
        choose(stop.stop, stop.start);
    }
}

std::vector<TourStop> TourSearch::tour() const {
    std::vector<TourStop> tour;
    tour.reserve(order_.size());
    for (const std::size_t place : order_) {
        tour.push_back({place, start_[place]});
    }
    return tour;
}

double TourSearch::length_mm() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < order_.size(); ++i) {
        sum += (entry_[order_[i]] - exit_before(i)).norm();
    }
    return sum;
}

void TourSearch::descend() {
    for (std::size_t i = 0; i < order_.size(); ++i) {
        touch(i);
    }
    drain();
}

void TourSearch::kick(std::int64_t evaluations, Random& random) {
    const std::size_t count = order_.size();
    if (count < 4) {
        return;
    }
    writes_journal_ = true;
    const std::int64_t end = evaluations_ + evaluations;
    const std::size_t longest = std::max<std::size_t>(1, std::min(kLongestKick, count / 3));
    while (evaluations_ < end) {
        context_.check();
        const std::size_t first = 1 + random.below(longest);
        const std::size_t second = 1 + random.below(longest);
        const std::size_t low = random.below(count + 1 - first - second);
        const std::size_t middle = low + first;
        const std::size_t high = middle + second;
        evaluations_ += 8;
        if (!may_pass(low, middle, high)) {
            continue;
        }
        journal_.clear();
        gained_mm_ = 0.0;
        shift_ends(low, middle, high);
        drain();
        if (gained_mm_ < 0.0) {
            undo();
        }
    }
    writes_journal_ = false;
    journal_.clear();
}

// Swaps the runs [low, middle) and [middle, high), whatever it costs.
void TourSearch::shift_ends(std::size_t low, std::size_t middle, std::size_t high) {
    const auto cost = [&](std::size_t position) {
        return position < order_.size() ? way(exit_before(position), entry_[order_[position]])
                                        : 0.0;
    };
    const double before = cost(low) + cost(middle) + cost(high);
    rotate(low, middle, high);
    const std::size_t joint = low + high - middle;
    gained_mm_ += before - cost(low) - cost(joint) - cost(high);
    for (const std::size_t position : {low, joint, high}) {
        touch(position);
    }
}

// The places on both sides of the way into `position`.
void TourSearch::touch(std::size_t position) {
    const std::size_t low = position == 0 ? 0 : position - 1;
    for (std::size_t i = low; i <= position && i < order_.size(); ++i) {
        if (queued_[order_[i]] == 0) {
            queued_[order_[i]] = 1;
            queue_.push_back(order_[i]);
        }
    }
}

void TourSearch::drain() {
    for (std::size_t next = 0; next < queue_.size(); ++next) {
        const std::size_t place = queue_[next];
        queued_[place] = 0;
        if (next % 64 == 63) {
            context_.check();
        }
        while (improve(place)) {
        }
    }
    queue_.clear();
}

bool TourSearch::improve(std::size_t place) {
    if (try_start(place)) {
        return true;
    }
    for (const std::size_t other : neighbours_[place]) {
        const std::size_t low = std::min(position_[place], position_[other]);
        const std::size_t high = std::max(position_[place], position_[other]);
        if (try_reversal(low + 1, high) || try_reversal(low, high - 1) || try_moves(place, other)) {
            return true;
        }
    }
    return false;
}

std::size_t TourSearch::best_start(std::size_t place,
                                   const Eigen::Vector2d& before,
                                   const Eigen::Vector2d* after) {
    const std::vector<TourStart>& starts = problem_.places[place].starts;
    const auto cost = [&](std::size_t i) {
        return way(before, starts[i].entry) +
               (after == nullptr ? 0.0 : way(starts[i].exit, *after));
    };
    const bool all = starts.size() <= 2 * kStride;
    std::size_t best = 0;
    double least = cost(0);
    const auto look_at = [&](std::size_t i) {
        if (const double here = cost(i); here < least) {
            least = here;
            best = i;
        }
    };
    for (std::size_t i = all ? 1 : kStride; i < starts.size(); i += all ? 1 : kStride) {
        look_at(i);
    }
    if (!all) {
        const std::size_t centre = best;
        for (std::size_t k = 1; k < kStride; ++k) {
            look_at((centre + k) % starts.size());
            look_at((centre + starts.size() - k) % starts.size());
        }
    }
    return best;
}

// Another start where the place stands.
bool TourSearch::try_start(std::size_t place) {
    if (problem_.places[place].starts.size() < 2) {
        return false;
    }
    const std::size_t here = position_[place];
    const Eigen::Vector2d& before = exit_before(here);
    const Eigen::Vector2d* after = here + 1 < order_.size() ? &entry_[order_[here + 1]] : nullptr;
    const std::size_t start = best_start(place, before, after);
    const TourStart& found = problem_.places[place].starts[start];
    double gain = way(before, entry_[place]) - way(before, found.entry);
    if (after != nullptr) {
        gain += way(exit_[place], *after) - way(found.exit, *after);
    }
    if (gain <= kGainMm) {
        return false;
    }
    gained_mm_ += gain;
    choose(place, start);
    touch(here);
    touch(here + 1);
    return true;
}

// 2-opt: brings the exits, or the entries, of two places together by running all between backward.
bool TourSearch::try_reversal(std::size_t first, std::size_t last) {
    const std::size_t head = at(first);
    const std::size_t tail = at(last);
    const Eigen::Vector2d& before = exit_before(first);
    double gain = way(before, entry_[head]) - way(before, exit_[tail]);
    if (last + 1 < order_.size()) {
        const Eigen::Vector2d& after = entry_[order_[last + 1]];
        gain += way(exit_[tail], after) - way(entry_[head], after);
    }
    if (gain <= kGainMm || !may_reverse(first, last)) {
        return false;
    }
    gained_mm_ += gain;
    reverse(first, last);
    touch(first);
    touch(last + 1);
    return true;
}

// Or-opt: up to three places beginning or ending with `place`, to before or after `other`.
bool TourSearch::try_moves(std::size_t place, std::size_t other) {
    const std::size_t here = position_[place];
    const std::size_t there = position_[other];
    for (std::size_t run = 1; run <= kLongestRun; ++run) {
        if (here + run <= order_.size() &&
            (try_move(here, here + run - 1, there) || try_move(here, here + run - 1, there + 1))) {
            return true;
        }
        if (run > 1 && here + 1 >= run &&
            (try_move(here + 1 - run, here, there) || try_move(here + 1 - run, here, there + 1))) {
            return true;
        }
    }
    return try_placing(place, there) || try_placing(place, there + 1);
}

// Moves the run [first, last] to between target - 1 and target, either way round.
bool TourSearch::try_move(std::size_t first, std::size_t last, std::size_t target) {
    if (target >= first && target <= last + 1) {
        return false;
    }
    const std::size_t head = at(first);
    const std::size_t tail = at(last);
    const Eigen::Vector2d& before = exit_before(first);
    double saved = way(before, entry_[head]);
    if (last + 1 < order_.size()) {
        const Eigen::Vector2d& after = entry_[order_[last + 1]];
        saved += way(exit_[tail], after) - way(before, after);
    }
    if (saved <= kGainMm) {
        return false;
    }
    const Eigen::Vector2d& leave = exit_before(target);
    double forward = way(leave, entry_[head]);
    double backward = way(leave, exit_[tail]);
    if (target < order_.size()) {
        const Eigen::Vector2d& onto = entry_[order_[target]];
        saved += way(leave, onto);
        forward += way(exit_[tail], onto);
        backward += way(entry_[head], onto);
    }
    const bool turns = backward < forward;
    const double gain = saved - std::min(forward, backward);
    const std::size_t low = std::min(first, target);
    const std::size_t high = std::max(last + 1, target);
    const std::size_t middle = target < first ? first : last + 1;
    if (gain <= kGainMm || !may_pass(low, middle, high) || (turns && !may_reverse(first, last))) {
        return false;
    }
    gained_mm_ += gain;
    if (turns) {
        reverse(first, last);
    }
    rotate(low, middle, high);
    for (const std::size_t position : {low, low + high - middle, high}) {
        touch(position);
    }
    return true;
}

// Moves a closed place to between target - 1 and target, with the start that is best there.
bool TourSearch::try_placing(std::size_t place, std::size_t target) {
    const std::size_t here = position_[place];
    if (problem_.places[place].open || problem_.places[place].starts.size() < 2 || target == here ||
        target == here + 1) {
        return false;
    }
    const Eigen::Vector2d& before = exit_before(here);
    double saved = way(before, entry_[place]);
    if (here + 1 < order_.size()) {
        const Eigen::Vector2d& after = entry_[order_[here + 1]];
        saved += way(exit_[place], after) - way(before, after);
    }
    const Eigen::Vector2d& leave = exit_before(target);
    const Eigen::Vector2d* onto = target < order_.size() ? &entry_[order_[target]] : nullptr;
    if (saved <= kGainMm) {
        return false;
    }
    const std::size_t start = best_start(place, leave, onto);
    const TourStart& found = problem_.places[place].starts[start];
    double gain = saved - way(leave, found.entry);
    if (onto != nullptr) {
        gain += way(leave, *onto) - way(found.exit, *onto);
    }
    const std::size_t low = std::min(here, target);
    const std::size_t high = std::max(here + 1, target);
    const std::size_t middle = target < here ? here : here + 1;
    if (gain <= kGainMm || !may_pass(low, middle, high)) {
        return false;
    }
    gained_mm_ += gain;
    choose(place, start);
    rotate(low, middle, high);
    for (const std::size_t position : {low, low + high - middle, high}) {
        touch(position);
    }
    return true;
}

bool TourSearch::may_reverse(std::size_t first, std::size_t last) const {
    if (earlier_.empty()) {
        return true;
    }
    for (std::size_t i = first + 1; i <= last; ++i) {
        for (const std::size_t other : earlier_[order_[i]]) {
            if (position_[other] >= first) {
                return false;
            }
        }
    }
    return true;
}

// Whether [middle, high) may come before [low, middle).
bool TourSearch::may_pass(std::size_t low, std::size_t middle, std::size_t high) const {
    if (earlier_.empty()) {
        return true;
    }
    if (middle - low <= high - middle) {
        for (std::size_t i = low; i < middle; ++i) {
            for (const std::size_t other : later_[order_[i]]) {
                if (position_[other] < high) {
                    return false;
                }
            }
        }
        return true;
    }
    for (std::size_t i = middle; i < high; ++i) {
        for (const std::size_t other : earlier_[order_[i]]) {
            if (position_[other] >= low) {
                return false;
            }
        }
    }
    return true;
}

void TourSearch::choose(std::size_t place, std::size_t start) {
    if (writes_journal_) {
        journal_.push_back({0, place, 0, start_[place], false});
    }
    start_[place] = start;
    entry_[place] = problem_.places[place].starts[start].entry;
    exit_[place] = problem_.places[place].starts[start].exit;
}

void TourSearch::reverse(std::size_t first, std::size_t last) {
    if (writes_journal_) {
        journal_.push_back({first, 0, last + 1, 0, true});
    }
    turn_over(first, last);
}

void TourSearch::turn_over(std::size_t first, std::size_t last) {
    std::reverse(order_.begin() + offset(first), order_.begin() + offset(last) + 1);
    for (std::size_t i = first; i <= last; ++i) {
        const std::size_t place = order_[i];
        position_[place] = i;
        if (problem_.places[place].open) {
            start_[place] = 1 - start_[place];
            std::swap(entry_[place], exit_[place]);
        }
    }
}

void TourSearch::rotate(std::size_t low, std::size_t middle, std::size_t high) {
    if (writes_journal_) {
        journal_.push_back({low, middle, high, 0, false});
    }
    std::rotate(order_.begin() + offset(low), order_.begin() + offset(middle),
                order_.begin() + offset(high));
    for (std::size_t i = low; i < high; ++i) {
        position_[order_[i]] = i;
    }
}

void TourSearch::undo() {
    writes_journal_ = false;
    while (!journal_.empty()) {
        const Step step = journal_.back();
        journal_.pop_back();
        if (step.high == 0) {
            choose(step.middle, step.start);
        } else if (step.reversed) {
            turn_over(step.low, step.high - 1);
        } else {
            rotate(step.low, step.low + step.high - step.middle, step.high);
        }
    }
    writes_journal_ = true;
}

}  // namespace leafcutter::fab
