#include "geometry/sparse_solver.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string_view>
#include <utility>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "geometry/error.h"

#ifdef LEAFCUTTER_HAVE_CHOLMOD
#include <cholmod.h>

// CHOLMOD's dense kernels come from whatever BLAS is installed; these are there if it is OpenBLAS.
extern "C" {
[[gnu::weak]] void openblas_set_num_threads(int count);
[[gnu::weak]] char* openblas_get_config();
}
#endif

namespace leafcutter::geometry {

struct SparseSolver::Backend {
    Backend() = default;
    Backend(const Backend&) = delete;
    Backend& operator=(const Backend&) = delete;
    virtual ~Backend() = default;
    virtual Eigen::VectorXd solve(const Eigen::VectorXd& right_side) = 0;
    virtual void refactor(const SymmetricMatrix& lower) = 0;
};

namespace {

using Matrix = Eigen::SparseMatrix<double>;
using MatrixView = Eigen::Map<const Matrix>;

MatrixView view_of(const SymmetricMatrix& lower) {
    return {lower.size,
            lower.size,
            static_cast<Eigen::Index>(lower.value.size()),
            lower.column_start.data(),
            lower.row.data(),
            lower.value.data()};
}

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
    explicit LdltBackend(const MatrixView& lower) {
        factor_.analyzePattern(lower);
        factorize(lower);
    }
    void refactor(const SymmetricMatrix& lower) override { factorize(view_of(lower)); }

    Eigen::VectorXd solve(const Eigen::VectorXd& right_side) override {
        return factor_.solve(right_side);
    }

private:
    void factorize(const MatrixView& lower) {
        factor_.factorize(lower);
        // LDLT also takes indefinite matrices; ours must have positive pivots only.
        if (factor_.info() != Eigen::Success || !(factor_.vectorD().array() > 0.0).all()) {
            throw singular_system();
        }
    }

    Eigen::SimplicialLDLT<Matrix, Eigen::Lower> factor_;
};

#ifdef LEAFCUTTER_HAVE_CHOLMOD

// OpenBLAS without threads takes no care of callers that have some: their results would differ from
// run to run. One with threads would start its own beside ours, which gains nothing here.
bool blas_may_be_shared() {
    static const bool safe = [] {
        if (openblas_set_num_threads != nullptr) {
            openblas_set_num_threads(1);
        }
        if (openblas_get_config == nullptr) {
            return true;
        }
        const std::string_view config(openblas_get_config());
        return config.find("SINGLE_THREADED") == std::string_view::npos ||
               config.find("USE_LOCKING") != std::string_view::npos;
    }();
    return safe;
}

class CholmodBackend final : public SparseSolver::Backend {
public:
    explicit CholmodBackend(const MatrixView& lower)
        : size_(static_cast<std::size_t>(lower.rows())) {
        cholmod_start(&common_);
        common_.print = 0;
        // AMD alone: with one factorization for each pattern, trying several orderings costs more
        // than the best of them saves.
        common_.nmethods = 1;
        common_.method[0].ordering = CHOLMOD_AMD;
        common_.postorder = 1;
        common_.supernodal = blas_may_be_shared() ? CHOLMOD_AUTO : CHOLMOD_SIMPLICIAL;
        common_.final_ll = 1;  // LL' stops at a pivot <= 0, LDL' would go on.
        cholmod_sparse view = cholmod_view_of(lower);
        factor_ = cholmod_analyze(&view, &common_);
        if (factor_ == nullptr || !factorize(view)) {
            release();
            throw singular_system();
        }
    }
    CholmodBackend(const CholmodBackend&) = delete;
    CholmodBackend& operator=(const CholmodBackend&) = delete;
    ~CholmodBackend() override { release(); }

    void refactor(const SymmetricMatrix& lower) override {
        cholmod_sparse view = cholmod_view_of(view_of(lower));
        if (!factorize(view)) {
            throw singular_system();
        }
    }

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
    bool factorize(cholmod_sparse& view) {
        return cholmod_factorize(&view, factor_, &common_) != 0 && common_.status == CHOLMOD_OK &&
               factor_->minor == factor_->n;
    }

    // CHOLMOD's C interface knows no const; it changes nothing here.
    static cholmod_sparse cholmod_view_of(const MatrixView& lower) {
        cholmod_sparse view{};
        view.nrow = static_cast<std::size_t>(lower.rows());
        view.ncol = static_cast<std::size_t>(lower.cols());
        view.nzmax = static_cast<std::size_t>(lower.nonZeros());
        view.p = const_cast<int*>(lower.outerIndexPtr());  // NOLINT(*-const-cast)
        view.i = const_cast<int*>(lower.innerIndexPtr());  // NOLINT(*-const-cast)
        view.x = const_cast<double*>(lower.valuePtr());    // NOLINT(*-const-cast)
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

namespace {

std::unique_ptr<SparseSolver::Backend> make_backend(const MatrixView& lower,
                                                    Factorization factorization) {
    if (!is_available(factorization)) {
        throw Error(ErrorKind::NotSupported, "no-cholmod",
                    "CHOLMOD is not in this build: configure with LEAFCUTTER_CHOLMOD=ON");
    }
#ifdef LEAFCUTTER_HAVE_CHOLMOD
    if (factorization == Factorization::Cholmod) {
        return std::make_unique<CholmodBackend>(lower);
    }
#endif
    return std::make_unique<LdltBackend>(lower);
}

}  // namespace

SparseSolver::SparseSolver(int size,
                           const std::vector<MatrixEntry>& lower,
                           Factorization factorization) {
    const Matrix matrix = assemble(size, lower);
    backend_ = make_backend({matrix.rows(), matrix.cols(), matrix.nonZeros(),
                             matrix.outerIndexPtr(), matrix.innerIndexPtr(), matrix.valuePtr()},
                            factorization);
}

SparseSolver::SparseSolver(const SymmetricMatrix& lower, Factorization factorization)
    : backend_(make_backend(view_of(lower), factorization)) {}

void SparseSolver::refactor(const SymmetricMatrix& lower) {
    backend_->refactor(lower);
}

SparseSolver::~SparseSolver() = default;
SparseSolver::SparseSolver(SparseSolver&&) noexcept = default;
SparseSolver& SparseSolver::operator=(SparseSolver&&) noexcept = default;

Eigen::VectorXd SparseSolver::solve(const Eigen::VectorXd& right_side) const {
    return backend_->solve(right_side);
}

}  // namespace leafcutter::geometry
