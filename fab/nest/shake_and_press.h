// A search for long bands that turn freely: shakes a part of what it has, frees it of overlaps in a
// little more room, and presses it; keeps what became smaller, or nearly so. An iterated local
// search (Lourenço, Martin and Stützle, "Iterated local search", Handbook of Metaheuristics, 2003)
// whose local search moves all parts at once: bands that lie side by side over their whole length
// hardly move one at a time.

#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "fab/nest/board.h"
#include "fab/nest/large_swap.h"
#include "fab/nest/random.h"
#include "fab/nest/relaxation.h"
#include "fab/nest/search.h"
#include "fab/nest/separation.h"

namespace leafcutter::fab {

class ShakeAndPress : public Search {
public:
    ShakeAndPress(const BoardPlan& plan, const Packing& start, std::uint64_t seed);

    void advance(std::int64_t evaluations, double progress, const std::stop_token& stop) override;
    const Packing& best() const override { return best_; }
    double best_area() const override { return best_area_; }
    std::int64_t evaluations() const override {
        return board_.evaluations() + relaxation_.evaluations();
    }
    void adopt(const Packing& better) override;

private:
    void begin_trial();
    void lay_anew();
    bool is_freed(const std::stop_token& stop);
    void press();
    void judge(const Packing& pressed);

    const BoardPlan& plan_;
    Random random_;
    Board board_;
    Separation separation_;
    PoseSearch search_;
    Relaxation relaxation_;
    LargeSwap swap_;
    Packing best_;
    Packing current_;  // What is shaken next.
    double best_area_ = 0.0;
    double current_area_ = 0.0;
    double progress_ = 0.0;
    bool first_ = true;     // Nothing was shaken yet.
    bool working_ = false;  // On a trial.
    int rounds_ = 0;        // Of the trial.
};

}  // namespace leafcutter::fab
