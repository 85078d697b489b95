// What lies on the base strips while others are woven into them, and which of them can still be
// folded back where.

#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "fab/weave/lay_order.h"

namespace leafcutter::fab {

// One cell of a strip that is woven in, and the base strip's there.
struct LayStep {
    int own = 0;         // The cell of what is woven in,
    int strip = 0;       // the base strip,
    int cell = 0;        // its cell there,
    bool under = false;  // and whether what is woven in lies under it.
};

// The ordered cells from one open joint (or end) of a strip to the next.
std::vector<std::vector<int>> segments_of(const Strip& strip, const std::vector<int>& joints);

class LayFront {
public:
    // All joints of base strips are open. `problem` must outlive this object.
    LayFront(const LayProblem& problem, std::span<const int> members, Family base);

    // Nothing is woven in.
    void clear();

    // How many cells of a strip would have to be threaded, laid from first to last or backwards.
    int threaded(const std::vector<LayStep>& steps, bool backwards);

    void lay(const std::vector<LayStep>& steps, bool backwards);

    // Whether something is woven in on this base strip, but not beside the step.
    bool leaves_gap(const LayStep& step) const;

    // The cells before and behind on the base strip; -1 where there is none.
    std::array<int, 2> cells_beside(const LayStep& step) const;

private:
    // Where on a segment, by rank, the first and the last strip lies that holds it down.
    struct Holds {
        int first = std::numeric_limits<int>::max();
        int last = -1;
    };

    void add_base(int index);
    std::size_t place(const LayStep& step) const;
    bool meet(const LayStep& step);

    const LayProblem& problem_;
    std::vector<std::size_t> places_;      // Per strip, where its cells begin in what follows.
    std::vector<std::size_t> segment_of_;  // Per base cell,
    std::vector<int> rank_;                // its place on the segment,
    std::vector<char> laid_;               // and whether something lies there.
    std::vector<char> begun_;              // Per strip.
    std::size_t segments_ = 0;
    std::vector<Holds> holds_;                            // Per segment.
    std::vector<std::pair<std::size_t, Holds>> journal_;  // What meet() changed.
};

}  // namespace leafcutter::fab
