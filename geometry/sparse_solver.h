// Direct solution of sparse symmetric positive definite systems: factor once, solve many.

#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

namespace leafcutter::geometry {

// One entry of the lower triangle (row >= column). Entries of equal place add up.
struct MatrixEntry {
    int row = 0;
    int column = 0;
    double value = 0.0;
};

enum class Factorization {
    Cholmod,  // CHOLMOD, supernodal where that pays. Only in builds with LEAFCUTTER_CHOLMOD.
    Ldlt,     // Eigen's simplicial LDLT.
};

bool is_available(Factorization factorization);
Factorization default_factorization();  // Cholmod where available.

// The factor of one matrix. Not for use from two threads at once.
class SparseSolver {
public:
    // Throws Error(SelfCheck, "singular-system") if the matrix isn't positive definite or not
    // finite, and Error(NotSupported) if `factorization` is not available.
    SparseSolver(int size,
                 const std::vector<MatrixEntry>& lower,
                 Factorization factorization = default_factorization());
    ~SparseSolver();
    SparseSolver(SparseSolver&&) noexcept;
    SparseSolver& operator=(SparseSolver&&) noexcept;

    // `right_side` has `size` entries.
    Eigen::VectorXd solve(const Eigen::VectorXd& right_side) const;

    struct Backend;  // Internal: one implementation for each factorization.

private:
    std::unique_ptr<Backend> backend_;
};

}  // namespace leafcutter::geometry
