// Least squares in whole numbers, under linear conditions: which numbers of cells come closest to
// the lengths of leaves and still fit together.
//
// Exact. The conditions' integer kernel is a lattice, reduced by Lenstra, Lenstra and Lovász,
// "Factoring polynomials with rational coefficients", 1982, and searched after Schnorr and Euchner,
// "Lattice basis reduction", 1994. The search is centred at the best real solution that keeps the
// inequalities: by convexity nothing is lost, and without that coarse problems are hopeless.

#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "geometry/context.h"

namespace leafcutter::geometry {

struct IntegerConditions {
    Eigen::MatrixXi zero;         // Each row's sum with the numbers must be 0,
    Eigen::MatrixXi bounded;      // and each of these
    Eigen::VectorXi lower_bound;  // at least this.
};

struct IntegerSolution {
    Eigen::VectorXi numbers;
    double cost = 0.0;
    bool proven = false;    // No others cost less; else the best of those looked at.
    std::size_t nodes = 0;  // Of the search tree.
};

class IntegerProgram {
public:
    // Costs are |forms numbers - targets|²; `forms` is one-to-one on the numbers that `conditions`
    // allow. Its reduction serves for any targets. Throws Error(SelfCheck) unless they are finite.
    IntegerProgram(const Eigen::MatrixXd& forms, IntegerConditions conditions);

    // The cheapest numbers, looking at `most_nodes` at most; none if no numbers keep the
    // conditions, as far as is found.
    std::optional<IntegerSolution> solve(const Eigen::VectorXd& targets,
                                         std::size_t most_nodes,
                                         const Context& context) const;

private:
    bool allowed(const Eigen::VectorXi& place) const;
    Eigen::VectorXd best_real(const Eigen::VectorXd& centre) const;
    Eigen::VectorXi rounded(const Eigen::VectorXd& point) const;
    std::optional<Eigen::VectorXi> first_allowed(const Eigen::VectorXd& point) const;

    IntegerConditions conditions_;
    Eigen::MatrixXi basis_;     // Columns: the reduced lattice, as numbers.
    Eigen::MatrixXd forms_;     // On the lattice,
    Eigen::MatrixXd rotation_;  // = rotation_ * upper_.
    Eigen::MatrixXd upper_;
    Eigen::MatrixXi bounded_;       // The inequalities on the lattice,
    Eigen::MatrixXd bounded_real_;  // and on upper_ times it.
};

}  // namespace leafcutter::geometry
