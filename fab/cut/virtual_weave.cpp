#include "fab/cut/virtual_weave.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "geometry/sparse_solver.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using Entries = std::vector<geometry::MatrixEntry>;

constexpr int kMostSteps = 20;
constexpr double kStillPart = 1e-7;  // Of the diagonal: steps smaller than this end it.
constexpr double kShortMm = 1e-9;    // Vertices that fall together have no direction.

std::size_t index(int value) {
    return static_cast<std::size_t>(value);
}

class Weaver {
public:
    Weaver(const geometry::QuadMesh& plan, std::span<const MeasuredLength> lengths)
        : plan_(plan.vertices), lengths_(lengths), at_(plan.vertices) {
        double sum = 0.0;
        std::size_t count = 0;
        for (const MeasuredLength& length : lengths) {
            sum += (at_[index(length.from)] - at_[index(length.to)]).norm();
            ++count;
        }
        diagonal_ = diagonal_of(plan_);
        const double part = sum / static_cast<double>(std::max<std::size_t>(count, 1)) /
                            std::max(diagonal_, kShortMm);
        spring_ = std::max(part * part, 1e-12);
    }

    std::vector<Vector3d> run(const geometry::Context& context) {
        double damping = 0.0;
        double cost = cost_of(at_);
        for (int step = 0; step < kMostSteps; ++step) {
            context.check();
            const std::vector<Vector3d> next = stepped(damping);
            const double next_cost = cost_of(next);
            if (!(next_cost <= cost)) {
                damping = damping > 0.0 ? 8.0 * damping : 1e-2;
                continue;
            }
            double moved = 0.0;
            for (std::size_t i = 0; i < next.size(); ++i) {
                moved = std::max(moved, (next[i] - at_[i]).norm());
            }
            at_ = next;
            cost = next_cost;
            damping = damping > 1e-6 ? damping / 8.0 : 0.0;
            if (moved <= kStillPart * diagonal_) {
                break;
            }
        }
        return at_;
    }

private:
    double cost_of(const std::vector<Vector3d>& at) const {
        double cost = 0.0;
        for (const MeasuredLength& length : lengths_) {
            const double miss = (at[index(length.from)] - at[index(length.to)]).norm() - length.mm;
            cost += miss * miss;
        }
        for (std::size_t i = 0; i < at.size(); ++i) {
            cost += spring_ * (at[i] - plan_[i]).squaredNorm();
        }
        return cost;
    }

    // Normal equations of the linearised lengths: a 3 x 3 block for each vertex and each pair.
    Entries assemble(double damping, VectorXd& right) const {
        Entries entries;
        entries.reserve(lengths_.size() * 24 + at_.size() * 3);
        const auto size = static_cast<Eigen::Index>(3 * at_.size());
        right = VectorXd::Zero(size);
        for (const MeasuredLength& length : lengths_) {
            const Vector3d d = at_[index(length.from)] - at_[index(length.to)];
            const double now = d.norm();
            if (now <= kShortMm) {
                continue;
            }
            const Vector3d direction = d / now;
            const Vector3d pull = (now - length.mm) * direction;
            right.segment<3>(Eigen::Index{3} * length.from) -= pull;
            right.segment<3>(Eigen::Index{3} * length.to) += pull;
            add_blocks({length.from, length.to}, direction * direction.transpose(), entries);
        }
        for (std::size_t i = 0; i < at_.size(); ++i) {
            const auto row = static_cast<int>(3 * i);
            right.segment<3>(row) -= spring_ * (at_[i] - plan_[i]);
            for (int k = 0; k < 3; ++k) {
                entries.push_back({row + k, row + k, spring_ + damping});
            }
        }
        return entries;
    }

    // The lower triangle only.
    static void add_blocks(const std::array<int, 2>& pair,
                           const Eigen::Matrix3d& block,
                           Entries& entries) {
        for (const int vertex : pair) {
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j <= i; ++j) {
                    entries.push_back({3 * vertex + i, 3 * vertex + j, block(i, j)});
                }
            }
        }
        const auto [low, high] = std::minmax(pair[0], pair[1]);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                entries.push_back({3 * high + i, 3 * low + j, -block(i, j)});
            }
        }
    }

    std::vector<Vector3d> stepped(double damping) const {
        VectorXd right;
        const Entries entries = assemble(damping, right);
        const VectorXd step =
            geometry::SparseSolver(static_cast<int>(right.size()), entries).solve(right);
        std::vector<Vector3d> next = at_;
        for (std::size_t i = 0; i < next.size(); ++i) {
            next[i] += step.segment<3>(static_cast<Eigen::Index>(3 * i));
        }
        return next;
    }

    const std::vector<Vector3d>& plan_;
    std::span<const MeasuredLength> lengths_;
    std::vector<Vector3d> at_;
    double diagonal_ = 0.0;
    double spring_ = 0.0;
};

}  // namespace

std::vector<Vector3d> weave_virtually(const geometry::QuadMesh& plan,
                                      std::span<const MeasuredLength> lengths,
                                      const geometry::Context& context) {
    if (plan.vertices.empty() || lengths.empty()) {
        return plan.vertices;
    }
    return Weaver(plan, lengths).run(context);
}

double diagonal_of(const std::vector<Vector3d>& vertices) {
    if (vertices.empty()) {
        return 0.0;
    }
    Vector3d low = vertices.front();
    Vector3d high = low;
    for (const Vector3d& vertex : vertices) {
        low = low.cwiseMin(vertex);
        high = high.cwiseMax(vertex);
    }
    return (high - low).norm();
}

double largest_disagreement_mm(std::vector<MeasuredLength> lengths) {
    for (MeasuredLength& length : lengths) {
        if (length.from > length.to) {
            std::swap(length.from, length.to);
        }
    }
    const auto key = [](const MeasuredLength& length) {
        return std::tuple(length.from, length.to, length.family, length.mm);
    };
    std::sort(lengths.begin(), lengths.end(),
              [&](const MeasuredLength& a, const MeasuredLength& b) { return key(a) < key(b); });
    double largest = 0.0;
    for (std::size_t first = 0; first < lengths.size();) {
        std::array<double, 2> low{std::numeric_limits<double>::infinity(),
                                  std::numeric_limits<double>::infinity()};
        std::array<double, 2> high{-low[0], -low[1]};
        std::size_t next = first;
        for (; next < lengths.size() && lengths[next].from == lengths[first].from &&
               lengths[next].to == lengths[first].to;
             ++next) {
            const std::size_t family = lengths[next].family == Family::Weft ? 0 : 1;
            low[family] = std::min(low[family], lengths[next].mm);
            high[family] = std::max(high[family], lengths[next].mm);
        }
        if (std::isfinite(low[0]) && std::isfinite(low[1])) {
            largest = std::max({largest, high[0] - low[1], high[1] - low[0]});
        }
        first = next;
    }
    return largest;
}

}  // namespace leafcutter::fab
