#include <atomic>
#include <limits>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/sparse_solver.h"

namespace leafcutter::geometry {
namespace {

class SparseSolverTest : public ::testing::TestWithParam<Factorization> {
protected:
    void SetUp() override {
        if (!is_available(GetParam())) {
            GTEST_SKIP() << "not in this build";
        }
    }
};

// 2 on the diagonal, -1 beside it.
std::vector<MatrixEntry> chain(int size) {
    std::vector<MatrixEntry> lower;
    for (int i = 0; i < size; ++i) {
        lower.push_back({i, i, 2.0});
        if (i > 0) {
            lower.push_back({i, i - 1, -1.0});
        }
    }
    return lower;
}

TEST_P(SparseSolverTest, SolvesSeveralRightSidesWithOneFactor) {
    const int n = 200;
    const SparseSolver solver(n, chain(n), GetParam());
    // Constant load 1: x_i = (i + 1)(n - i) / 2.
    const Eigen::VectorXd parabola = solver.solve(Eigen::VectorXd::Ones(n));
    // A pull at the last vertex only: a straight line.
    const Eigen::VectorXd line = solver.solve(Eigen::VectorXd::Unit(n, n - 1));
    for (int i = 0; i < n; ++i) {
        EXPECT_NEAR(parabola[i], 0.5 * (i + 1) * (n - i), 1e-8);
        EXPECT_NEAR(line[i], (i + 1.0) / (n + 1.0), 1e-12);
    }
}

TEST_P(SparseSolverTest, AddsUpEntriesOfEqualPlace) {
    const SparseSolver solver(2, {{0, 0, 1.0}, {1, 0, -1.0}, {1, 1, 3.0}, {0, 0, 1.0}, {1, 0, 0.5}},
                              GetParam());
    const Eigen::VectorXd x = solver.solve(Eigen::Vector2d(2.0 - 0.5, -0.5 + 3.0));
    EXPECT_NEAR(x[0], 1.0, 1e-14);
    EXPECT_NEAR(x[1], 1.0, 1e-14);
}

// Large enough for supernodes, which call the BLAS.
TEST_P(SparseSolverTest, GivesSeveralThreadsTheSameAnswers) {
    constexpr int kSide = 60;
    std::vector<MatrixEntry> lower;
    for (int v = 0; v < kSide * kSide; ++v) {
        lower.push_back({v, v, 4.01});
        if (v % kSide != 0) {
            lower.push_back({v, v - 1, -1.0});
        }
        if (v >= kSide) {
            lower.push_back({v, v - kSide, -1.0});
        }
    }
    const Eigen::VectorXd load = Eigen::VectorXd::LinSpaced(kSide * kSide, -1.0, 2.0);
    const auto solve = [&] { return SparseSolver(kSide * kSide, lower, GetParam()).solve(load); };
    const Eigen::VectorXd alone = solve();
    std::atomic<int> different{0};
    {
        std::vector<std::jthread> threads;
        for (int t = 0; t < 4; ++t) {
            threads.emplace_back([&] {
                for (int round = 0; round < 40; ++round) {
                    try {
                        different += solve() != alone ? 1 : 0;
                    } catch (const Error&) {
                        ++different;
                    }
                }
            });
        }
    }
    EXPECT_EQ(different, 0);
}

TEST_P(SparseSolverTest, RefusesWhatIsNotPositiveDefinite) {
    std::vector<MatrixEntry> indefinite = chain(5);
    indefinite[0].value = -2.0;
    EXPECT_THROW(SparseSolver(5, indefinite, GetParam()), Error);
    // The Laplacian of a graph with nothing held: constants are in its kernel.
    const std::vector<MatrixEntry> singular{{0, 0, 0.0}, {1, 1, 1.0}};
    EXPECT_THROW(SparseSolver(2, singular, GetParam()), Error);
}

TEST_P(SparseSolverTest, RefusesNumbersThatAreNotFinite) {
    std::vector<MatrixEntry> bad = chain(5);
    bad[2].value = std::numeric_limits<double>::quiet_NaN();
    try {
        const SparseSolver solver(5, bad, GetParam());
        FAIL() << "took NaN";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::SelfCheck);
        EXPECT_EQ(error.code(), "singular-system");
    }
}

TEST_P(SparseSolverTest, KeepsItsFactorWhenMoved) {
    SparseSolver first(3, chain(3), GetParam());
    const SparseSolver second = std::move(first);
    EXPECT_NEAR(second.solve(Eigen::Vector3d(1.0, 0.0, 1.0))[1], 1.0, 1e-14);
}

INSTANTIATE_TEST_SUITE_P(Both,
                         SparseSolverTest,
                         ::testing::Values(Factorization::Cholmod, Factorization::Ldlt),
                         [](const auto& tested) {
                             return tested.param == Factorization::Cholmod ? "Cholmod" : "Ldlt";
                         });

TEST(SparseSolver, BothFactorizationsGiveTheSameSolution) {
    if (!is_available(Factorization::Cholmod)) {
        GTEST_SKIP() << "CHOLMOD is not in this build";
    }
    const int side = 60;
    std::vector<MatrixEntry> lower;
    for (int i = 0; i < side * side; ++i) {
        lower.push_back({i, i, 4.0 + 0.01 * (i % 7)});
        if (i % side > 0) {
            lower.push_back({i, i - 1, -1.0});
        }
        if (i >= side) {
            lower.push_back({i, i - side, -1.0});
        }
    }
    const Eigen::VectorXd load = Eigen::VectorXd::LinSpaced(side * side, -1.0, 1.0);
    const Eigen::VectorXd a = SparseSolver(side * side, lower, Factorization::Cholmod).solve(load);
    const Eigen::VectorXd b = SparseSolver(side * side, lower, Factorization::Ldlt).solve(load);
    EXPECT_LT((a - b).norm(), 1e-12 * a.norm());
}

}  // namespace
}  // namespace leafcutter::geometry
