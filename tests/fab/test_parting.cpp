#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "fab/strips/parting_plan.h"

namespace leafcutter::fab {
namespace {

// A run that is good while the weights of its cells add up to no more than 1.
PartingProblem random_problem(unsigned seed, bool closed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    PartingProblem problem;
    problem.cells = 2 + static_cast<int>(random() % 8);
    problem.closed = closed;
    std::vector<double> weight;
    for (int i = 0; i < problem.cells; ++i) {
        problem.joint_cost.push_back(uniform(random));
        problem.length.push_back(0.2 + uniform(random));
        weight.push_back(0.7 * uniform(random));
    }
    problem.good = [weight](int first, int count) {
        double sum = 0.0;
        for (int i = 0; i < count; ++i) {
            sum += weight[static_cast<std::size_t>(first + i) % weight.size()];
        }
        return sum <= 1.0;
    };
    return problem;
}

struct Price {
    std::size_t parts = 0;
    double cost = std::numeric_limits<double>::infinity();
    bool sound = false;
};

Price price_of(const PartingProblem& problem, const std::vector<int>& firsts) {
    Price price{.parts = firsts.size(), .cost = 0.0, .sound = !firsts.empty()};
    double total = 0.0;
    for (const double length : problem.length) {
        total += length;
    }
    for (std::size_t i = 0; i < firsts.size(); ++i) {
        const int behind = i + 1 < firsts.size()
                               ? firsts[i + 1]
                               : problem.cells + (problem.closed ? firsts.front() : 0);
        const int count = behind - firsts[i];
        price.sound = price.sound && count > 0 && (count == 1 || problem.good(firsts[i], count));
        double length = 0.0;
        for (int k = firsts[i]; k < behind; ++k) {
            length += problem.length[static_cast<std::size_t>(k % problem.cells)];
        }
        const double off = length / (total / static_cast<double>(firsts.size())) - 1.0;
        price.cost += problem.evenness * off * off;
        if (problem.closed || i > 0) {
            price.cost += problem.joint_cost[static_cast<std::size_t>(firsts[i])];
        }
    }
    return price;
}

// Of all sets of joints the one with the fewest parts, then of least cost.
Price best_of_all(const PartingProblem& problem) {
    Price best{.parts = std::numeric_limits<std::size_t>::max()};
    for (int set = 1; set < 1 << problem.cells; ++set) {
        std::vector<int> firsts;
        for (int i = 0; i < problem.cells; ++i) {
            if ((set >> i) % 2 == 1) {
                firsts.push_back(i);
            }
        }
        if (!problem.closed && firsts.front() != 0) {
            continue;
        }
        const Price price = price_of(problem, firsts);
        if (price.sound &&
            (price.parts < best.parts || (price.parts == best.parts && price.cost < best.cost))) {
            best = price;
        }
    }
    return best;
}

void expect_best(bool closed) {
    for (unsigned seed = 1; seed <= 300; ++seed) {
        const PartingProblem problem = random_problem(seed, closed);
        const Price got = price_of(problem, plan_parting(problem));
        const Price best = best_of_all(problem);
        EXPECT_TRUE(got.sound) << "seed " << seed;
        EXPECT_EQ(got.parts, best.parts) << "seed " << seed;
        EXPECT_NEAR(got.cost, best.cost, 1e-9) << "seed " << seed;
    }
}

TEST(PlanParting, FindsTheFewestAndCheapestPartsOfOpenRuns) {
    expect_best(false);
}

TEST(PlanParting, FindsTheFewestAndCheapestPartsOfClosedRuns) {
    expect_best(true);
}

TEST(PlanParting, TakesSingleCellsThatAreNoGood) {
    PartingProblem problem;
    problem.cells = 3;
    problem.joint_cost.assign(3, 1.0);
    problem.length.assign(3, 1.0);
    problem.good = [](int, int) { return false; };
    EXPECT_EQ(plan_parting(problem), (std::vector<int>{0, 1, 2}));
}

// Good runs with bad runs inside them: what is planned is tried out all the same.
TEST(PlanParting, NeverReturnsARunThatIsNoGood) {
    for (unsigned seed = 1; seed <= 200; ++seed) {
        PartingProblem problem = random_problem(seed, seed % 2 == 0);
        const auto good = problem.good;
        problem.good = [good, seed](int first, int count) {
            return good(first, count) && (seed * 31U + static_cast<unsigned>(first) * 7U +
                                          static_cast<unsigned>(count) * 13U) %
                                                 5U !=
                                             0U;
        };
        EXPECT_TRUE(price_of(problem, plan_parting(problem)).sound) << "seed " << seed;
    }
}

}  // namespace
}  // namespace leafcutter::fab
