// A search for long bands that turn freely: moves one of them elsewhere, or shakes some and frees
// them of overlaps in a little more room, and presses all; keeps what became smaller, or nearly so.
// An iterated local search (Lourenço, Martin and Stützle, "Iterated local search", Handbook of
// Metaheuristics, 2003) whose local search moves all parts at once: bands that lie side by side
// over their whole length hardly move one at a time.

#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "fab/nest/board.h"
#include "fab/nest/insertion.h"
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
    const Packing& best() const override { return best_.packing; }
    double best_area() const override { return best_.area; }
    std::int64_t evaluations() const override {
        return board_.evaluations() + relaxation_.evaluations() + insertion_.evaluations();
    }
    void adopt(const Packing& better) override;

private:
    struct Layout {
        Packing packing;
        double area = 0.0;
        Packing settled;  // As of Insertion::settle(), once that is asked for.
    };

    // What one of the two kinds of change gave for its evaluations, the latest ones above all.
    struct Yield {
        double gain = 0.0;  // Shares of the area.
        double work = 0.0;
        double whole_work = 0.0;  // All so far.

        void add(double more_gain, double more_work);
        double rate() const { return gain / work; }
    };

    bool shakes_next() const;
    void insert();
    void begin_shaking();
    void lay_anew();
    void shake_on(const std::stop_token& stop);
    void press_shaken();
    double tolerance();
    void judge(Layout pressed, double worse);

    const BoardPlan& plan_;
    Random random_;
    Board board_;
    Separation separation_;
    PoseSearch search_;
    Relaxation relaxation_;
    Insertion insertion_;
    LargeSwap swap_;
    Layout best_;
    Layout current_;  // What is changed next.
    double progress_ = 0.0;
    std::int64_t until_ = 0;      // Work asked for so far.
    bool first_ = true;           // Nothing was shaken yet.
    int rounds_left_ = 0;         // Of the shaking under way; 0: none is.
    std::int64_t round_end_ = 0;  // In the board's evaluations.
    Yield inserting_;
    Yield shaking_;
};

}  // namespace leafcutter::fab
