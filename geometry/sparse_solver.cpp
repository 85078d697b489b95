#include "geometry/sparse_solver.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "geometry/error.h"

#ifdef LEAFCUTTER_HAVE_CHOLMOD
#include <cholmod.h>
#endif

namespace leafcutter::geometry {

struct SparseSolver::Backend {
    Backend() = default;
    Backend(const Backend&) = delete;
    Backend& operator=(const Backend&) = delete;
    virtual ~Backend() = default;
    virtual Eigen::VectorXd solve(const Eigen::VectorXd& right_side) = 0;
};

namespace {

using Matrix = Eigen::SparseMatrix<double>;

Error singular_system() {
    return {ErrorKind::SelfCheck, "singular-system",
            "a linear system of the foliation is not positive definite: the mesh has parts of zero "
            "area or coordinates beyond the range of numbers; repair or rescale it"};
}

Matrix assemble(int size, const std::vector<MatrixEntry>& lower) {
    std::vector<Eigen::Triplet<double>> triplets;
    triplets.reserve(lower.size());
    for (const MatrixEntry& entry : lower) {
        assert(entry.row >= entry.column);
        if (!std::isfinite(entry.value)) {
            throw singular_system();
        }
        triplets.emplace_back(entry.row, entry.column, entry.value);
    }
    Matrix matrix(size, size);
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    return matrix;
}

class LdltBackend final : public SparseSolver::Backend {
public:
    explicit LdltBackend(const Matrix& lower) {
        factor_.compute(lower);
        // LDLT also takes indefinite matrices; ours must have positive pivots only.
        if (factor_.info() != Eigen::Success || !(factor_.vectorD().array() > 0.0).all()) {
            throw singular_system();
        }
    }

    Eigen::VectorXd solve(const Eigen::VectorXd& right_side) override {
        return factor_.solve(right_side);
    }

private:
    Eigen::SimplicialLDLT<Matrix, Eigen::Lower> factor_;
};

#ifdef LEAFCUTTER_HAVE_CHOLMOD

class CholmodBackend final : public SparseSolver::Backend {
public:
    explicit CholmodBackend(Matrix lower) : size_(static_cast<std::size_t>(lower.rows())) {
        cholmod_start(&common_);
        common_.print = 0;
        // AMD alone: with one factorization for each pattern, trying several orderings costs more
        // than the best of them saves.
        common_.nmethods = 1;
        common_.method[0].ordering = CHOLMOD_AMD;
        common_.postorder = 1;
        common_.final_ll = 1;  // LL' stops at a pivot <= 0, LDL' would go on.
        cholmod_sparse view = view_of(lower);
        factor_ = cholmod_analyze(&view, &common_);
        const bool factored = factor_ != nullptr &&
                              cholmod_factorize(&view, factor_, &common_) != 0 &&
                              common_.status == CHOLMOD_OK && factor_->minor == factor_->n;
        if (!factored) {
            release();
            throw singular_system();
        }
    }
    CholmodBackend(const CholmodBackend&) = delete;
    CholmodBackend& operator=(const CholmodBackend&) = delete;
    ~CholmodBackend() override { release(); }

    Eigen::VectorXd solve(const Eigen::VectorXd& right_side) override {
        Eigen::VectorXd copy = right_side;  // CHOLMOD's C interface knows no const.
        cholmod_dense view{};
        view.nrow = size_;
        view.ncol = 1;
        view.nzmax = size_;
        view.d = size_;
        view.x = copy.data();
        view.xtype = CHOLMOD_REAL;
        view.dtype = CHOLMOD_DOUBLE;
        cholmod_dense* result = cholmod_solve(CHOLMOD_A, factor_, &view, &common_);
        if (result == nullptr) {
            throw singular_system();
        }
        const auto* values = static_cast<const double*>(result->x);
        std::copy(values, values + size_, copy.data());
        cholmod_free_dense(&result, &common_);
        return copy;
    }

private:
    static cholmod_sparse view_of(Matrix& lower) {
        cholmod_sparse view{};
        view.nrow = static_cast<std::size_t>(lower.rows());
        view.ncol = static_cast<std::size_t>(lower.cols());
        view.nzmax = static_cast<std::size_t>(lower.nonZeros());
        view.p = lower.outerIndexPtr();
        view.i = lower.innerIndexPtr();
        view.x = lower.valuePtr();
        view.stype = -1;
        view.itype = CHOLMOD_INT;
        view.xtype = CHOLMOD_REAL;
        view.dtype = CHOLMOD_DOUBLE;
        view.sorted = 1;
        view.packed = 1;
        return view;
    }

    void release() {
        cholmod_free_factor(&factor_, &common_);
        cholmod_finish(&common_);
    }

    std::size_t size_;
    cholmod_common common_{};
    cholmod_factor* factor_ = nullptr;
};

#endif

}  // namespace

bool is_available(Factorization factorization) {
#ifdef LEAFCUTTER_HAVE_CHOLMOD
    return factorization == Factorization::Cholmod || factorization == Factorization::Ldlt;
#else
    return factorization == Factorization::Ldlt;
#endif
}

Factorization default_factorization() {
    return is_available(Factorization::Cholmod) ? Factorization::Cholmod : Factorization::Ldlt;
}

SparseSolver::SparseSolver(int size,
                           const std::vector<MatrixEntry>& lower,
                           Factorization factorization) {
    if (!is_available(factorization)) {
        throw Error(ErrorKind::NotSupported, "no-cholmod",
                    "CHOLMOD is not in this build: configure with LEAFCUTTER_CHOLMOD=ON");
    }
    Matrix matrix = assemble(size, lower);
#ifdef LEAFCUTTER_HAVE_CHOLMOD
    if (factorization == Factorization::Cholmod) {
        backend_ = std::make_unique<CholmodBackend>(std::move(matrix));
        return;
    }
#endif
    backend_ = std::make_unique<LdltBackend>(matrix);
}

SparseSolver::~SparseSolver() = default;
SparseSolver::SparseSolver(SparseSolver&&) noexcept = default;
SparseSolver& SparseSolver::operator=(SparseSolver&&) noexcept = default;

Eigen::VectorXd SparseSolver::solve(const Eigen::VectorXd& right_side) const {
    return backend_->solve(right_side);
}

}  // namespace leafcutter::geometry
