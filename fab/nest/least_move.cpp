#include "fab/nest/least_move.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace leafcutter::fab {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kDamping = 1e-3;  // So small that only the least of equal moves is meant.
constexpr int kNewtonSteps = 12;
constexpr double kSettled = 1e-3;  // Share of the energy that a step must gain.

}  // namespace

LeastMove::LeastMove(std::size_t items, const std::vector<Contact>& contacts, const EdgePush& edge)
    : items_(items),
      contacts_(contacts),
      edge_(edge),
      short_by_(contacts.size()),
      slope_(contacts.size()) {
    for (std::size_t k = 0; k < contacts.size(); ++k) {
        short_by_[k] = contacts[k].want;
        const bool next = k == 0 || contacts[k].item != contacts[k - 1].item ||
                          contacts[k].other != contacts[k - 1].other;
        if (next) {
            groups_.push_back({k, k, 0});
        }
        groups_.back().end = k + 1;
    }
    lay_out();
}

// Columns of the lower triangle: the rest of the diagonal block, a block of three rows for each
// item of a higher number that touches, the edge's row.
void LeastMove::lay_out() {
    std::vector<std::pair<std::size_t, std::size_t>> touching;
    for (const Group& group : groups_) {
        if (between_items(group)) {
            touching.push_back(
                std::minmax(contacts_[group.begin].item, contacts_[group.begin].other));
        }
    }
    std::sort(touching.begin(), touching.end());
    touching.erase(std::unique(touching.begin(), touching.end()), touching.end());
    const auto size = static_cast<int>(3 * items_ + 1);
    matrix_.size = size;
    blocks_.assign(items_, 0);
    auto next = touching.begin();
    for (std::size_t item = 0; item < items_; ++item) {
        const auto first = next;
        next = std::find_if(next, touching.end(), [&](const auto& t) { return t.first != item; });
        blocks_[item] = static_cast<std::size_t>(next - first);
        const int row = static_cast<int>(3 * item);
        for (int column = 0; column < 3; ++column) {
            matrix_.column_start.push_back(static_cast<int>(matrix_.row.size()));
            for (int k = column; k < 3; ++k) {
                matrix_.row.push_back(row + k);
            }
            for (auto at = first; at != next; ++at) {
                for (int k = 0; k < 3; ++k) {
                    matrix_.row.push_back(static_cast<int>(3 * at->second) + k);
                }
            }
            matrix_.row.push_back(size - 1);
        }
    }
    matrix_.column_start.push_back(static_cast<int>(matrix_.row.size()));
    matrix_.row.push_back(size - 1);
    matrix_.column_start.push_back(static_cast<int>(matrix_.row.size()));
    matrix_.value.resize(matrix_.row.size());
    for (Group& group : groups_) {
        if (between_items(group)) {
            const auto pair =
                std::minmax(contacts_[group.begin].item, contacts_[group.begin].other);
            const std::pair<std::size_t, std::size_t> start(pair.first, 0);
            const auto first = std::lower_bound(touching.begin(), touching.end(), start);
            const auto at =
                std::lower_bound(first, touching.end(), std::pair<std::size_t, std::size_t>(pair));
            group.block = static_cast<std::size_t>(at - first);
        }
    }
}

// Of an item's diagonal block, row >= column.
double& LeastMove::cell(std::size_t item, Index row, Index column) {
    const auto start = matrix_.column_start[3 * item + static_cast<std::size_t>(column)];
    return matrix_.value[static_cast<std::size_t>(start + row - column)];
}

// Of the block of two items, the row being the higher one's.
double& LeastMove::cell(const Group& group, Index row, Index column) {
    const std::size_t low = std::min(contacts_[group.begin].item, contacts_[group.begin].other);
    const auto start = matrix_.column_start[3 * low + static_cast<std::size_t>(column)];
    return matrix_.value[static_cast<std::size_t>(start + 3 - column + row) + 3 * group.block];
}

LeastMove::Normal LeastMove::sum_up(const Group& group) const {
    Normal sum;
    for (std::size_t k = group.begin; k < group.end; ++k) {
        if (short_by_[k] <= 0.0) {
            continue;
        }
        const Contact& contact = contacts_[k];
        sum.any = true;
        sum.item += contact.item_gain * contact.item_gain.transpose();
        sum.other += contact.other_gain * contact.other_gain.transpose();
        sum.mixed += contact.item_gain * contact.other_gain.transpose();
        sum.item_right += contact.want * contact.item_gain;
        sum.other_right += contact.want * contact.other_gain;
    }
    return sum;
}

void LeastMove::add(const Group& group, const Normal& sum) {
    const auto [item, other] = std::pair(contacts_[group.begin].item, contacts_[group.begin].other);
    const bool above = item > other;
    right_.segment<3>(static_cast<Index>(3 * item)) += sum.item_right;
    if (between_items(group)) {
        right_.segment<3>(static_cast<Index>(3 * other)) += sum.other_right;
    }
    for (Index column = 0; column < 3; ++column) {
        for (Index row = column; row < 3; ++row) {
            cell(item, row, column) += sum.item(row, column);
            if (between_items(group)) {
                cell(other, row, column) += sum.other(row, column);
            }
        }
        for (Index row = 0; row < 3 && between_items(group); ++row) {
            cell(group, row, column) += above ? sum.mixed(row, column) : sum.mixed(column, row);
        }
    }
    if (at_edge(group)) {
        matrix_.value.back() += sum.other(0, 0);
        right_[right_.size() - 1] += sum.other_right.x();
        for (std::size_t i = 0; i < 3; ++i) {
            const auto last = static_cast<std::size_t>(matrix_.column_start[3 * item + i + 1]) - 1;
            matrix_.value[last] += sum.mixed(static_cast<Index>(i), 0);
        }
    }
}

// Where the energy is least if the contacts that are short of distance stay the same.
LeastMove::Vector LeastMove::newton() {
    std::fill(matrix_.value.begin(), matrix_.value.end(), 0.0);
    right_ = Vector::Zero(matrix_.size);
    for (std::size_t item = 0; item < items_; ++item) {
        for (Index i = 0; i < 3; ++i) {
            cell(item, i, i) = kDamping;
        }
    }
    matrix_.value.back() = edge_.push > 0.0 ? edge_.push / edge_.trust : 1.0;
    right_[right_.size() - 1] = -edge_.push;
    for (const Group& group : groups_) {
        const Normal sum = sum_up(group);
        if (sum.any) {
            add(group, sum);
        }
    }
    // Eigen's factorisation gives the same bits whatever else is installed.
    if (solver_) {
        solver_->refactor(matrix_);
    } else {
        solver_.emplace(matrix_, geometry::Factorization::Ldlt);
    }
    return solver_->solve(right_);
}

void LeastMove::find_slopes(const Vector& way) {
    for (const Group& group : groups_) {
        const Vector3d item = way.segment<3>(static_cast<Index>(3 * contacts_[group.begin].item));
        Vector3d other = Vector3d::Zero();
        if (between_items(group)) {
            other = way.segment<3>(static_cast<Index>(3 * contacts_[group.begin].other));
        } else if (at_edge(group)) {
            other.x() = way[way.size() - 1];
        }
        for (std::size_t k = group.begin; k < group.end; ++k) {
            slope_[k] = contacts_[k].item_gain.dot(item) + contacts_[k].other_gain.dot(other);
        }
    }
}

// After a share of the way.
double LeastMove::energy(const Vector& move, const Vector& way, double share) const {
    const Vector to = move + share * way;
    const double edge_moves = to[to.size() - 1];
    double sum = kDamping * to.head(to.size() - 1).squaredNorm();
    if (edge_.push > 0.0) {
        sum += edge_.push * edge_moves * (edge_moves / edge_.trust + 2.0);
    }
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        const double left = std::max(0.0, short_by_[k] - share * slope_[k]);
        sum += left * left;
    }
    return sum;
}

Eigen::VectorXd LeastMove::solve() {
    Vector move = Vector::Zero(matrix_.size);
    double now = energy(move, move, 0.0);
    for (int step = 0; step < kNewtonSteps; ++step) {
        const Vector way = newton() - move;
        find_slopes(way);
        double share = 1.0;
        double next = energy(move, way, share);
        while (next > now && share > 0.01) {
            share *= 0.5;
            next = energy(move, way, share);
        }
        if (next >= now) {
            break;
        }
        move += share * way;
        for (std::size_t k = 0; k < contacts_.size(); ++k) {
            short_by_[k] -= share * slope_[k];
        }
        const bool settled = now - next < kSettled * std::abs(now);
        now = next;
        if (settled) {
            break;
        }
    }
    return move;
}

}  // namespace leafcutter::fab
