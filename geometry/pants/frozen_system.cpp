#include "geometry/pants/frozen_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace leafcutter::geometry {
namespace {

// Steps are exact enough at this residual, by the first, in the preconditioner's norm.
constexpr double kWantedResidual = 1e-3;
// A preconditioner that doesn't get here in time is worth a new factor.
constexpr double kPoorResidual = 1e-1;
constexpr int kMostIterations = 14;
// About as many solves as one numeric factorization costs.
constexpr int kSolvesWorthAFactor = 20;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

}  // namespace

FrozenSystem::FrozenSystem(const VertexRings& rings,
                           std::span<const double> weights,
                           std::size_t vertices)
    : rings_(rings),
      weights_(weights),
      terms_(rings.edges.size()),
      diagonal_(vertices, 0.0),
      place_(rings.edges.size()) {
    // Column by column: the diagonal, then the neighbours of higher number.
    matrix_.size = static_cast<int>(vertices);
    matrix_.column_start.push_back(0);
    matrix_.row.reserve(vertices + rings.edges.size());
    std::vector<std::pair<int, int>> below;
    for (std::size_t v = 0; v < vertices; ++v) {
        const int column = static_cast<int>(v);
        below.clear();
        for (int k = rings.begin[v]; k < rings.begin[v + 1]; ++k) {
            const RingSlot& slot = rings.slots[at(k)];
            if (slot.neighbour > column) {
                below.emplace_back(slot.neighbour, slot.edge);
            }
        }
        std::sort(below.begin(), below.end());
        matrix_.row.push_back(column);
        for (const auto& [row, edge] : below) {
            place_[at(edge)] = static_cast<int>(matrix_.row.size());
            matrix_.row.push_back(row);
        }
        matrix_.column_start.push_back(static_cast<int>(matrix_.row.size()));
    }
    matrix_.value.assign(matrix_.row.size(), 0.0);
}

// Sets the terms and returns the negative gradient of the energy.
Eigen::VectorXd FrozenSystem::freeze(const GraphMap& map, std::span<const char> active) {
    Eigen::VectorXd right = Eigen::VectorXd::Zero(matrix_.size);
    std::fill(diagonal_.begin(), diagonal_.end(), 0.0);
    for (std::size_t e = 0; e < rings_.edges.size(); ++e) {
        const int a = rings_.edges[e].from;
        const int b = rings_.edges[e].to;
        const Word& word = map.words[e];
        double rise = map.t[at(b)] - map.t[at(a)];
        double from_sign = 1.0;
        double to_sign = 1.0;
        if (!word.empty()) {
            from_sign = runs_forward(word.front()) ? 1.0 : -1.0;
            to_sign = runs_forward(word.back()) ? 1.0 : -1.0;
            rise = map.distance(a, b, word);
        }
        const double w = weights_[e];
        diagonal_[at(a)] += w;
        diagonal_[at(b)] += w;
        right[a] += w * from_sign * rise;
        right[b] -= w * to_sign * rise;
        const bool joins = active[at(a)] != 0 && active[at(b)] != 0;
        terms_[e] = {w, static_cast<signed char>(joins ? from_sign * to_sign : 0.0)};
    }
    for (std::size_t v = 0; v < active.size(); ++v) {
        if (active[v] == 0) {
            right[static_cast<Eigen::Index>(v)] = 0.0;
        }
    }
    return right;
}

void FrozenSystem::factor() {
    for (std::size_t v = 0; v < diagonal_.size(); ++v) {
        matrix_.value[at(matrix_.column_start[v])] = diagonal_[v];
    }
    for (std::size_t e = 0; e < terms_.size(); ++e) {
        matrix_.value[at(place_[e])] = -terms_[e].weight * terms_[e].sign;
    }
    if (factor_) {
        factor_->refactor(matrix_);
    } else {
        factor_.emplace(matrix_);
    }
    ++factorizations_;
    solves_with_factor_ = 0;
}

void FrozenSystem::multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
    y = Eigen::Map<const Eigen::VectorXd>(diagonal_.data(), x.size()).cwiseProduct(x);
    for (std::size_t e = 0; e < terms_.size(); ++e) {
        if (terms_[e].sign != 0) {
            const double w = terms_[e].weight * terms_[e].sign;
            y[rings_.edges[e].from] -= w * x[rings_.edges[e].to];
            y[rings_.edges[e].to] -= w * x[rings_.edges[e].from];
        }
    }
}

Eigen::VectorXd FrozenSystem::precondition(const Eigen::VectorXd& r,
                                           const std::vector<signed char>& gauge) {
    ++solves_;
    ++solves_with_factor_;
    Eigen::VectorXd turned(r.size());
    for (Eigen::Index v = 0; v < r.size(); ++v) {
        turned[v] = r[v] * gauge[static_cast<std::size_t>(v)];
    }
    turned = factor_->solve(turned);
    for (Eigen::Index v = 0; v < r.size(); ++v) {
        turned[v] *= gauge[static_cast<std::size_t>(v)];
    }
    return turned;
}

// Returns whether x is good enough to be used.
bool FrozenSystem::iterate(Eigen::VectorXd& x,
                           const Eigen::VectorXd& right,
                           const std::vector<signed char>& gauge,
                           const Context& context) {
    Eigen::VectorXd r = right;
    Eigen::VectorXd z = precondition(r, gauge);
    Eigen::VectorXd p = z;
    Eigen::VectorXd product(right.size());
    double rho = r.dot(z);
    const double first = rho;
    for (int iteration = 0; iteration < kMostIterations && rho > 0.0; ++iteration) {
        context.check();
        multiply(p, product);
        const double curvature = p.dot(product);
        if (!(curvature > 0.0)) {
            return false;
        }
        x += (rho / curvature) * p;
        r -= (rho / curvature) * product;
        if (r.squaredNorm() <= 1e-24 * right.squaredNorm()) {
            return true;
        }
        z = precondition(r, gauge);
        const double next = r.dot(z);
        if (next <= kWantedResidual * kWantedResidual * first) {
            return true;
        }
        p = z + (next / rho) * p;
        rho = next;
    }
    return rho <= kPoorResidual * kPoorResidual * first;
}

Eigen::VectorXd FrozenSystem::newton_direction(const GraphMap& map,
                                               std::span<const char> active,
                                               std::vector<signed char>& gauge,
                                               const Context& context) {
    const Eigen::VectorXd right = freeze(map, active);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(matrix_.size);
    if (right.squaredNorm() == 0.0) {
        return x;
    }
    if (factor_ && solves_with_factor_ < kSolvesWorthAFactor && iterate(x, right, gauge, context)) {
        return x;
    }
    factor();
    std::fill(gauge.begin(), gauge.end(), static_cast<signed char>(1));
    return precondition(right, gauge);
}

}  // namespace leafcutter::geometry
