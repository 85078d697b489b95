// Where a run of cells is parted: into the fewest parts that are good, and of those ways the
// cheapest.

#pragma once

#include <functional>
#include <vector>

namespace leafcutter::fab {

struct PartingProblem {
    int cells = 0;
    bool closed = false;
    std::vector<double> joint_cost;  // Per cell: of a joint before it.
    std::vector<double> length;      // Per cell.
    double evenness = 0.5;           // Cost of a part that is twice as long as the mean.
    // Whether `count` cells from `first` on make a good part; runs of closed ones wrap. What holds
    // for a run should hold for the runs inside it. Single cells are taken, good or not.
    std::function<bool(int first, int count)> good;
};

// First cells of the parts, growing: 0 first if it is not closed; of a closed one also its single
// part's. Dynamic programme over the cells: the end of the longest good run grows with its first
// cell, so that few runs need be tried.
std::vector<int> plan_parting(const PartingProblem& problem);

}  // namespace leafcutter::fab
