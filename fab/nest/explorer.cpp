#include "fab/nest/explorer.h"

#include <algorithm>
#include <cmath>

namespace leafcutter::fab {

namespace {

constexpr double kFirstShrink = 0.01;
constexpr double kFinestShrink = 0.001;
constexpr double kRestartsUntil = 0.5;  // Of the whole search.
// With many copies of each part, where a swap of two changes little, hops take over sooner.
constexpr double kHopsFrom = 0.25;
constexpr std::size_t kStalled = 3;  // Attempts in vain at one target.
// An attempt is given up after a while, counted in the whole search, and after more for large jobs.
constexpr double kLongAttempt = 0.015;
constexpr double kLongestAttempt = 0.1;
constexpr std::int64_t kLongPerItem = 5000;  // Evaluations.

}  // namespace

Explorer::Explorer(const BoardPlan& plan, const Packing& start, std::uint64_t seed)
    : plan_(plan),
      random_(seed),
      board_(plan),
      separation_(board_, random_),
      search_(board_, random_),
      swap_(plan),
      start_(start),
      best_(start),
      best_area_(area_taken(plan, start.extent)),
      home_(start),
      home_area_(best_area_) {
    board_.restore(best_.positions, best_.extent);
}

void Explorer::adopt(const Packing& better) {
    best_ = better;
    best_area_ = area_taken(plan_, better.extent);
    home_ = best_;
    home_area_ = best_area_;
    hopping_ = false;
    failed_.clear();
    // An attempt at more than what is known to be possible is in vain.
    if (working_ && area_taken(plan_, target_) >= best_area_) {
        working_ = false;
    }
}

void Explorer::advance(std::int64_t evaluations, double progress, const std::stop_token& stop) {
    progress_ = progress;
    if (working_ && compressing() && !compressed_) {
        working_ = false;
    }
    const std::int64_t until = board_.evaluations() + evaluations;
    while (board_.evaluations() < until) {
        const std::int64_t before = board_.evaluations();
        if (!working_) {
            begin_attempt();
        }
        const Separation::State state = separation_.run(until, stop);
        if (state == Separation::State::Feasible) {
            succeed();
        } else if (state == Separation::State::GaveUp || takes_long()) {
            fail();
        }
        if (board_.evaluations() == before) {
            return;  // Nothing left to try.
        }
    }
}

bool Explorer::takes_long() const {
    const double share = progress_ - begun_;
    const auto patience = kLongPerItem * static_cast<std::int64_t>(board_.items());
    return share > kLongestAttempt ||
           (share > kLongAttempt && board_.evaluations() - begun_evaluations_ > patience);
}

void Explorer::begin_attempt() {
    begun_ = progress_;
    begun_evaluations_ = board_.evaluations();
    working_ = true;
    compressed_ = compressing();
    if (compressed_) {
        begin_compressing();
    } else {
        begin_exploring();
    }
}

void Explorer::begin_exploring() {
    constexpr double kMiddle = 0.5;
    if (hopping_) {
        begin_hop();
        return;
    }
    if (failed_.empty()) {
        target_ = extent_of_area(plan_, best_area_ * (1.0 - shrink_));
        attempt(best_.positions, best_.extent, target_, kMiddle);
        return;
    }
    // One of those that came near, a good one more likely, with two large parts swapped.
    std::vector<Position> positions = failed_[random_.early(failed_.size(), 0.25)].positions;
    swap_.apply(positions, random_);
    attempt(std::move(positions), target_, target_, kMiddle);
}

void Explorer::begin_compressing() {
    constexpr double kCoarse = 5e-4;
    constexpr double kFine = 1e-5;
    const double left = std::clamp((1.0 - progress_) / 0.2, 0.0, 1.0);
    target_ = extent_of_area(plan_, best_area_ * (1.0 - (kFine + (kCoarse - kFine) * left)));
    attempt(best_.positions, best_.extent, target_, random_.unit());
}

// What lies right of `split`, a share of the last sheet's width, moves along with its edge.
void Explorer::attempt(std::vector<Position> positions,
                       const Extent& from,
                       const Extent& to,
                       double split) {
    const double border = split * from.last_width;
    std::vector<std::size_t> homeless;
    for (std::size_t item = 0; item < positions.size(); ++item) {
        Position& at = positions[item];
        if (at.bin >= to.bins) {
            homeless.push_back(item);
            at.bin = static_cast<int>(random_.below(static_cast<std::size_t>(to.bins)));
        } else if (from.bins == to.bins && at.bin + 1 == to.bins && at.x > border) {
            at.x += to.last_width - from.last_width;
        }
    }
    board_.restore(positions, to);
    rehome(homeless);
    separation_.begin(compressed_ ? SeparationLimits{5, 100} : SeparationLimits{3, 200});
}

void Explorer::rehome(const std::vector<std::size_t>& homeless) {
    for (const std::size_t item : homeless) {
        board_.move(item, search_.best_for(item).position);
    }
}

void Explorer::succeed() {
    working_ = false;
    if (hopping_) {
        hopping_ = false;
        shrink_ = kFirstShrink;
    }
    best_ = {board_.positions(), board_.extent()};
    best_area_ = area_taken(plan_, best_.extent);
    failed_.clear();
    if (best_area_ <= home_area_) {
        home_ = best_;
        home_area_ = best_area_;
    }
}

void Explorer::fail() {
    working_ = false;
    if (compressed_) {
        return;
    }
    if (hopping_) {
        ++hops_in_vain_;
        return;
    }
    if (shrink_ > kFinestShrink) {
        // The step was too bold: a part of it may do.
        shrink_ = std::max(kFinestShrink, 0.5 * shrink_);
        failed_.clear();
        return;
    }
    Failed failed{separation_.best(), separation_.best_loss()};
    const auto at =
        std::upper_bound(failed_.begin(), failed_.end(), failed,
                         [](const Failed& a, const Failed& b) { return a.loss < b.loss; });
    failed_.insert(at, std::move(failed));
    constexpr std::size_t kMostKept = 40;
    failed_.resize(std::min(failed_.size(), kMostKept));
    if (failed_.size() < kStalled) {
        return;
    }
    if (has_many_copies(plan_) && progress_ >= kHopsFrom) {
        hop();
    } else if (progress_ < kRestartsUntil) {
        restart();
    }
}

// The valley it came down to depends on chance: it may be better to come down once more than to
// stay. Large jobs never get here, since they still gain.
void Explorer::restart() {
    best_ = start_;
    best_area_ = area_taken(plan_, start_.extent);
    shrink_ = kFirstShrink;
    failed_.clear();
}

// Copies wedged between the edges in rows as long as the sheet leave little but whole rows to gain,
// and most of that is out of reach from where they lie: a few large parts change places with room
// to do so, and the search comes down from there, worse at first.
void Explorer::hop() {
    hopping_ = true;
    hopped_ = true;
    hops_in_vain_ = 0;
    failed_.clear();
}

// With more room after each hop that came to nothing.
void Explorer::begin_hop() {
    constexpr double kWider = 0.02;
    constexpr double kYetWider = 0.01;
    constexpr int kSwaps = 3;
    std::vector<Position> positions = home_.positions;
    for (int i = 0; i < kSwaps; ++i) {
        swap_.apply(positions, random_);
    }
    target_ = extent_of_area(plan_, home_area_ * (1.0 + kWider + kYetWider * hops_in_vain_));
    attempt(std::move(positions), home_.extent, target_, random_.unit());
}

}  // namespace leafcutter::fab
