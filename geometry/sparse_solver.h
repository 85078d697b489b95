// Direct solution of sparse symmetric positive definite systems: factor once, solve many.

#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace leafcutter::geometry {

// One entry of the lower triangle (row >= column). Entries of equal place add up.
struct MatrixEntry {
    int row = 0;
    int column = 0;
    double value = 0.0;
};

// The lower triangle by columns: entries of column j are column_start[j] to column_start[j + 1] -
// 1, rows ascending, each place once.
struct SymmetricMatrix {
    int size = 0;
    std::vector<int> column_start;
    std::vector<int> row;
    std::vector<double> value;
};

enum class Factorization {
    Cholmod,  // CHOLMOD, supernodal where that pays. Only in builds with LEAFCUTTER_CHOLMOD.
    Ldlt,     // Eigen's simplicial LDLT.
};

bool is_available(Factorization factorization);
Factorization default_factorization();  // Cholmod where available.

// The factor of one matrix. One object is not for use from two threads at once, several are.
class SparseSolver {
public:
    // Throws Error(SelfCheck, "singular-system") if the matrix isn't positive definite or not
    // finite, and Error(NotSupported) if `factorization` is not available.
    SparseSolver(int size,
                 const std::vector<MatrixEntry>& lower,
                 Factorization factorization = default_factorization());
    explicit SparseSolver(const SymmetricMatrix& lower,
                          Factorization factorization = default_factorization());
    ~SparseSolver();
    SparseSolver(SparseSolver&&) noexcept;
    SparseSolver& operator=(SparseSolver&&) noexcept;

    // Takes other values at the same places; the ordering is kept. Throws as the constructor does.
    void refactor(const SymmetricMatrix& lower);

    // `right_side` has `size` entries.
    Eigen::VectorXd solve(const Eigen::VectorXd& right_side) const;

    struct Backend;  // Internal: one implementation for each factorization.

private:
    std::unique_ptr<Backend> backend_;
};

}  // namespace leafcutter::geometry
