#include "geometry/quads/integer_program.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include <Eigen/Dense>

#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXi;
using Eigen::VectorXd;
using Eigen::VectorXi;

constexpr double kLovasz = 0.99;
constexpr int kMostSteps = 50'000;
constexpr int kMostSweeps = 3000;
constexpr double kSettled = 1e-12;
// Starts: the real solution, ever longer, until its nearest lattice point is allowed.
constexpr double kStretch = 1.04;
constexpr int kMostStretches = 120;
constexpr std::size_t kNodesBetweenChecks = 4096;

// Makes all but one of the free columns zero in this row by Euclid's algorithm; that one is free no
// more.
void eliminate(const Eigen::RowVectorXi& row, MatrixXi& columns, std::vector<Index>& free) {
    while (true) {
        Index smallest = -1;
        int least = 0;
        int others = 0;
        for (const Index c : free) {
            const int value = row.dot(columns.col(c));
            if (value == 0) {
                continue;
            }
            ++others;
            if (smallest < 0 || std::abs(value) < std::abs(least)) {
                smallest = c;
                least = value;
            }
        }
        if (smallest < 0) {
            return;
        }
        if (others == 1) {
            free.erase(std::find(free.begin(), free.end(), smallest));
            return;
        }
        for (const Index c : free) {
            const int value = row.dot(columns.col(c));
            if (c != smallest && value != 0) {
                columns.col(c) -= (value / least) * columns.col(smallest);
            }
        }
    }
}

MatrixXi integer_kernel(const MatrixXi& zero, Index numbers) {
    MatrixXi columns = MatrixXi::Identity(numbers, numbers);
    std::vector<Index> free;
    for (Index c = 0; c < numbers; ++c) {
        free.push_back(c);
    }
    for (Index r = 0; r < zero.rows(); ++r) {
        eliminate(zero.row(r), columns, free);
    }
    MatrixXi kernel(numbers, static_cast<Index>(free.size()));
    for (std::size_t i = 0; i < free.size(); ++i) {
        kernel.col(static_cast<Index>(i)) = columns.col(free[i]);
    }
    return kernel;
}

// Reduces the columns of `basis` as vectors forms * basis.
class Reducer {
public:
    Reducer(const MatrixXd& forms, MatrixXi& basis)
        : basis_(basis), vectors_(forms * basis.cast<double>()), straight_(vectors_) {}

    // Any basis will do, a reduced one sooner: so a limit costs nothing but time.
    void run() {
        int steps = 0;
        for (Index k = 1; k < basis_.cols() && steps < kMostSteps; ++steps) {
            shorten(k);
            straighten(k);
            const double along =
                vectors_.col(k).dot(straight_.col(k - 1)) / straight_.col(k - 1).squaredNorm();
            if (straight_.col(k).squaredNorm() >=
                (kLovasz - along * along) * straight_.col(k - 1).squaredNorm()) {
                ++k;
                continue;
            }
            basis_.col(k).swap(basis_.col(k - 1));
            vectors_.col(k).swap(vectors_.col(k - 1));
            straighten(k - 1);
            k = std::max<Index>(k - 1, 1);
        }
    }

private:
    void shorten(Index k) {
        for (Index j = k - 1; j >= 0; --j) {
            const double along =
                vectors_.col(k).dot(straight_.col(j)) / straight_.col(j).squaredNorm();
            const int times = static_cast<int>(std::lround(along));
            if (times != 0) {
                basis_.col(k) -= times * basis_.col(j);
                vectors_.col(k) -= times * vectors_.col(j);
            }
        }
    }

    // The part of a column at right angles to all before it.
    void straighten(Index k) {
        straight_.col(k) = vectors_.col(k);
        for (Index j = 0; j < k; ++j) {
            straight_.col(k) -= straight_.col(k).dot(straight_.col(j)) /
                                straight_.col(j).squaredNorm() * straight_.col(j);
        }
    }

    MatrixXi& basis_;
    MatrixXd vectors_;
    MatrixXd straight_;
};

// Lattice points upper * place in order of nearness, level by level.
class Search {
public:
    Search(const MatrixXd& upper, const VectorXd& centre)
        : upper_(upper),
          centre_(centre),
          size_(upper.cols()),
          place_(VectorXi::Zero(size_)),
          wanted_(VectorXd::Zero(size_)),
          step_(VectorXi::Zero(size_)),
          above_(VectorXd::Zero(size_ + 1)) {
        enter(size_ - 1);
    }

    // Moves to the next place nearer than `radius2`; false if there is none. Counts nodes.
    template <typename Tick>
    bool next(double radius2, Tick&& tick) {
        if (started_) {
            advance(0);
        }
        started_ = true;
        while (level_ < size_) {
            if (!tick()) {
                return false;
            }
            const double off = upper_(level_, level_) * (place_[level_] - wanted_[level_]);
            const double sum = above_[level_ + 1] + off * off;
            if (sum >= radius2) {
                if (level_ + 1 == size_) {
                    return false;
                }
                advance(level_ + 1);
                continue;
            }
            above_[level_] = sum;
            if (level_ == 0) {
                return true;
            }
            enter(level_ - 1);
        }
        return false;
    }

    const VectorXi& place() const { return place_; }

private:
    void enter(Index level) {
        level_ = level;
        double rest = centre_[level];
        for (Index j = level + 1; j < size_; ++j) {
            rest -= upper_(level, j) * place_[j];
        }
        wanted_[level] = rest / upper_(level, level);
        place_[level] = static_cast<int>(std::lround(wanted_[level]));
        step_[level] = wanted_[level] >= place_[level] ? 1 : -1;
    }

    // To and fro round the wanted value, ever farther.
    void advance(Index level) {
        level_ = level;
        place_[level] += step_[level];
        step_[level] = step_[level] > 0 ? -step_[level] - 1 : -step_[level] + 1;
    }

    const MatrixXd& upper_;
    const VectorXd& centre_;
    Index size_;
    VectorXi place_;
    VectorXd wanted_;
    VectorXi step_;
    VectorXd above_;
    Index level_ = 0;
    bool started_ = false;
};

}  // namespace

IntegerProgram::IntegerProgram(const MatrixXd& forms, IntegerConditions conditions)
    : conditions_(std::move(conditions)), basis_(integer_kernel(conditions_.zero, forms.cols())) {
    if (!forms.allFinite()) {
        throw Error(ErrorKind::SelfCheck, "integer-program",
                    "quads: lengths of critical arcs are not finite");
    }
    Reducer(forms, basis_).run();
    forms_ = forms * basis_.cast<double>();
    const Index size = basis_.cols();
    const Eigen::HouseholderQR<MatrixXd> qr(forms_);
    rotation_ = qr.householderQ() * MatrixXd::Identity(forms_.rows(), size);
    upper_ = qr.matrixQR().topRows(size).triangularView<Eigen::Upper>();
    bounded_ = conditions_.bounded * basis_;
    bounded_real_ = upper_.triangularView<Eigen::Upper>()
                        .solve<Eigen::OnTheRight>(bounded_.cast<double>())
                        .eval();
}

bool IntegerProgram::allowed(const VectorXi& place) const {
    return ((bounded_ * place - conditions_.lower_bound).array() >= 0).all();
}

// The point nearest to `centre` that keeps the inequalities, in coordinates upper * place:
// Hildreth, "A quadratic programming procedure", 1957.
VectorXd IntegerProgram::best_real(const VectorXd& centre) const {
    VectorXd point = centre;
    VectorXd pull = VectorXd::Zero(bounded_real_.rows());
    const VectorXd squares = bounded_real_.rowwise().squaredNorm();
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
        double moved = 0.0;
        for (Index i = 0; i < pull.size(); ++i) {
            if (!(squares[i] > 0.0)) {
                continue;
            }
            const double lack = conditions_.lower_bound[i] - bounded_real_.row(i).dot(point);
            const double more = std::max(-pull[i], lack / squares[i]);
            pull[i] += more;
            point += more * bounded_real_.row(i).transpose();
            moved = std::max(moved, std::abs(more) * std::sqrt(squares[i]));
        }
        if (moved <= kSettled * (1.0 + centre.norm())) {
            break;
        }
    }
    return point;
}

// Babai's nearest plane.
VectorXi IntegerProgram::rounded(const VectorXd& point) const {
    VectorXi place = VectorXi::Zero(upper_.cols());
    for (Index i = upper_.cols() - 1; i >= 0; --i) {
        double rest = point[i];
        for (Index j = i + 1; j < upper_.cols(); ++j) {
            rest -= upper_(i, j) * place[j];
        }
        place[i] = static_cast<int>(std::lround(rest / upper_(i, i)));
    }
    return place;
}

std::optional<VectorXi> IntegerProgram::first_allowed(const VectorXd& point) const {
    double stretch = 1.0;
    for (int i = 0; i < kMostStretches; ++i, stretch *= kStretch) {
        VectorXi place = rounded(stretch * point);
        if (allowed(place)) {
            return place;
        }
    }
    return std::nullopt;
}

std::optional<IntegerSolution> IntegerProgram::solve(const VectorXd& targets,
                                                     std::size_t most_nodes,
                                                     const Context& context) const {
    const VectorXd ideal = rotation_.transpose() * targets;
    const VectorXd centre = best_real(ideal);
    const double least = (centre - ideal).squaredNorm();
    const auto cost_of = [&](const VectorXi& place) {
        return (upper_ * place.cast<double>() - ideal).squaredNorm();
    };
    std::optional<VectorXi> best = first_allowed(centre);
    double best_cost = best ? cost_of(*best) : std::numeric_limits<double>::infinity();
    IntegerSolution solution;
    Search search(upper_, centre);
    const auto tick = [&] {
        if (++solution.nodes % kNodesBetweenChecks == 0) {
            context.check();
        }
        return solution.nodes < most_nodes;
    };
    while (search.next(best_cost - least, tick)) {
        const double cost = cost_of(search.place());
        if (cost < best_cost && allowed(search.place())) {
            best = search.place();
            best_cost = cost;
        }
    }
    if (!best) {
        return std::nullopt;
    }
    solution.proven = solution.nodes < most_nodes;
    solution.numbers = basis_ * *best;
    solution.cost = (forms_ * best->cast<double>() - targets).squaredNorm();
    return solution;
}

}  // namespace leafcutter::geometry
