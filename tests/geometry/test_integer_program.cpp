// Least squares in whole numbers, against trying them all.

#include <limits>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "geometry/quads/integer_program.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXi;
using Eigen::VectorXd;
using Eigen::VectorXi;

constexpr std::size_t kPlenty = 10'000'000;

struct Problem {
    MatrixXd forms;
    VectorXd targets;
    IntegerConditions conditions;
};

// The least cost of all numbers in [0, most]^n that keep the conditions.
std::optional<double> cheapest(const Problem& problem, int most) {
    const Index size = problem.forms.cols();
    VectorXi numbers = VectorXi::Zero(size);
    std::optional<double> best;
    while (true) {
        const IntegerConditions& conditions = problem.conditions;
        if ((conditions.zero * numbers).isZero() &&
            ((conditions.bounded * numbers - conditions.lower_bound).array() >= 0).all()) {
            const double cost =
                (problem.forms * numbers.cast<double>() - problem.targets).squaredNorm();
            best = best ? std::min(*best, cost) : cost;
        }
        Index i = 0;
        while (i < size && numbers[i] == most) {
            numbers[i++] = 0;
        }
        if (i == size) {
            return best;
        }
        ++numbers[i];
    }
}

// Lengths near [0, 5] of six arcs round two nodes, circumferences equal on both sides of three
// rings, each at least 3, as on a surface of genus 2.
Problem two_nodes(std::mt19937& random) {
    std::uniform_real_distribution<double> length(0.0, 5.0);
    Problem problem;
    problem.forms = MatrixXd::Zero(6, 6);
    problem.targets.resize(6);
    for (Index a = 0; a < 6; ++a) {
        const double wished = length(random);
        const double weight = 1.0 / std::max(0.3, wished);
        problem.forms(a, a) = std::sqrt(weight);
        problem.targets[a] = std::sqrt(weight) * wished;
    }
    problem.conditions.zero.resize(3, 6);
    problem.conditions.zero << 1, 1, 0, -1, -1, 0,  //
        0, 1, 1, 0, -1, -1,                         //
        1, 0, 1, -1, 0, -1;
    problem.conditions.bounded.resize(9, 6);
    problem.conditions.bounded << MatrixXi::Identity(6, 6),  //
        (MatrixXi(3, 6) << 1, 1, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 1, 0, 0, 0).finished();
    problem.conditions.lower_bound.resize(9);
    problem.conditions.lower_bound << 1, 1, 1, 1, 1, 1, 3, 3, 3;
    return problem;
}

TEST(IntegerProgram, FindsTheCheapestOfAllNumbers) {
    std::mt19937 random(7);
    for (int i = 0; i < 40; ++i) {
        const Problem problem = two_nodes(random);
        const IntegerProgram program(problem.forms, problem.conditions);
        const auto found = program.solve(problem.targets, kPlenty, {});
        ASSERT_TRUE(found);
        EXPECT_TRUE(found->proven);
        EXPECT_TRUE((problem.conditions.zero * found->numbers).isZero());
        EXPECT_GE((problem.conditions.bounded * found->numbers - problem.conditions.lower_bound)
                      .minCoeff(),
                  0);
        EXPECT_NEAR(found->cost, *cheapest(problem, 6), 1e-9);
    }
}

TEST(IntegerProgram, KeepsSumsEven) {
    std::mt19937 random(11);
    for (int i = 0; i < 20; ++i) {
        const Problem plain = two_nodes(random);
        Problem even = plain;
        even.forms.conservativeResize(6, 7);
        even.forms.col(6).setZero();
        even.conditions.zero = MatrixXi::Zero(4, 7);
        even.conditions.zero.topLeftCorner(3, 6) = plain.conditions.zero;
        even.conditions.zero.row(3) << 1, 1, 0, 0, 0, 0, -2;
        even.conditions.bounded.conservativeResize(9, 7);
        even.conditions.bounded.col(6).setZero();
        const auto found =
            IntegerProgram(even.forms, even.conditions).solve(even.targets, kPlenty, {});
        ASSERT_TRUE(found);
        EXPECT_EQ((found->numbers[0] + found->numbers[1]) % 2, 0);
        EXPECT_NEAR(found->cost, *cheapest(even, 5), 1e-9);
    }
}

TEST(IntegerProgram, ReusesItsReductionForOtherTargets) {
    std::mt19937 random(3);
    Problem problem = two_nodes(random);
    const IntegerProgram program(problem.forms, problem.conditions);
    for (const double scale : {0.7, 1.0, 1.3}) {
        Problem scaled = problem;
        scaled.targets *= scale;
        EXPECT_NEAR(program.solve(scaled.targets, kPlenty, {})->cost, *cheapest(scaled, 6), 1e-9);
    }
}

TEST(IntegerProgram, SaysWhereItGaveUp) {
    std::mt19937 random(5);
    const Problem problem = two_nodes(random);
    const auto found =
        IntegerProgram(problem.forms, problem.conditions).solve(problem.targets, 1, {});
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->proven);
    EXPECT_TRUE((problem.conditions.zero * found->numbers).isZero());
}

}  // namespace
}  // namespace leafcutter::geometry
