// Where each region of a weave begins its pattern, so that it breaks at as few places as can be.
//
// Exact: regions are eliminated one after the other, each by the table of what its best start costs
// for all starts of those it meets ("nonserial dynamic programming", Bertelè and Brioschi, 1972).
// The tables stay small because a region meets few others.

#pragma once

#include <vector>

namespace leafcutter::fab {

// What two regions cost together: cost[i * starts + j] if `one` begins at i and `other` at j.
struct StartCost {
    int one = 0;
    int other = 0;
    std::vector<double> cost;
};

struct PatternStarts {
    std::vector<int> start;  // Per region, from 0.
    double cost = 0.0;
    bool proven = true;  // None cost less; else tables would have become too large.
};

// `regions` of them, each with as many `starts`. Pairs may come more than once.
PatternStarts choose_starts(int regions, int starts, const std::vector<StartCost>& costs);

}  // namespace leafcutter::fab
