// Starts of patterns against every other choice of them.

#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "fab/weave/pattern_starts.h"

namespace leafcutter::fab {
namespace {

double cost_of(const std::vector<int>& start, int starts, const std::vector<StartCost>& costs) {
    double sum = 0.0;
    for (const StartCost& pair : costs) {
        const int one = start[static_cast<std::size_t>(pair.one)];
        const int other = start[static_cast<std::size_t>(pair.other)];
        sum += pair.cost[static_cast<std::size_t>(one * starts + other)];
    }
    return sum;
}

double least_of_all(int regions, int starts, const std::vector<StartCost>& costs) {
    std::vector<int> start(static_cast<std::size_t>(regions), 0);
    double least = cost_of(start, starts, costs);
    while (true) {
        std::size_t i = 0;
        while (i < start.size() && ++start[i] == starts) {
            start[i++] = 0;
        }
        if (i == start.size()) {
            return least;
        }
        least = std::min(least, cost_of(start, starts, costs));
    }
}

std::vector<StartCost> random_costs(int regions, int starts, int pairs, std::mt19937& random) {
    std::uniform_int_distribution<int> region(0, regions - 1);
    std::uniform_int_distribution<int> cost(0, 20);
    std::vector<StartCost> costs;
    for (int i = 0; i < pairs; ++i) {
        StartCost pair{region(random), region(random), {}};
        if (pair.one == pair.other) {
            continue;
        }
        for (int k = 0; k < starts * starts; ++k) {
            pair.cost.push_back(cost(random));
        }
        costs.push_back(pair);
    }
    return costs;
}

TEST(PatternStarts, CostNoMoreThanAnyOthers) {
    std::mt19937 random(7);
    for (int round = 0; round < 40; ++round) {
        const int regions = 2 + round % 5;
        const int starts = 2 + round % 3;
        const auto costs = random_costs(regions, starts, 2 * regions, random);
        const PatternStarts found = choose_starts(regions, starts, costs);
        EXPECT_TRUE(found.proven);
        EXPECT_DOUBLE_EQ(found.cost, cost_of(found.start, starts, costs));
        EXPECT_DOUBLE_EQ(found.cost, least_of_all(regions, starts, costs));
    }
}

TEST(PatternStarts, SayWhereTheyAreNotProven) {
    std::mt19937 random(8);
    const int regions = 40;  // All meet all: no table is small.
    std::vector<StartCost> costs;
    for (int one = 0; one < regions; ++one) {
        for (int other = 0; other < one; ++other) {
            StartCost pair{one, other, {}};
            for (int k = 0; k < 16; ++k) {
                pair.cost.push_back(static_cast<double>(random() % 10));
            }
            costs.push_back(pair);
        }
    }
    const PatternStarts found = choose_starts(regions, 4, costs);
    EXPECT_FALSE(found.proven);
    EXPECT_DOUBLE_EQ(found.cost, cost_of(found.start, 4, costs));
    EXPECT_LE(found.cost, cost_of(std::vector<int>(40, 0), 4, costs));
}

}  // namespace
}  // namespace leafcutter::fab
