// The move of all parts that gives every contact the distance it wants.

#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "fab/nest/contacts.h"
#include "geometry/sparse_solver.h"

namespace leafcutter::fab {

// How the last sheet's right edge moves; pushes if `push` is above 0, else it stays.
struct EdgePush {
    double push = 0.0;
    double trust = 0.0;  // By which it moves if nothing is in its way.
};

// The least move, or the one that comes nearest to all distances: least squares over contacts that
// are short of distance, a convex problem, quadratic but for which contacts count. Newton's method.
class LeastMove {
public:
    // Of `items` items.
    LeastMove(std::size_t items, const std::vector<Contact>& contacts, const EdgePush& edge);

    // Rows: x, y and turn of each item, then the edge's move.
    Eigen::VectorXd solve();

private:
    using Index = Eigen::Index;
    using Vector = Eigen::VectorXd;

    // The contacts of one item with one other thing, which lie in a row.
    struct Group {
        std::size_t begin = 0;
        std::size_t end = 0;
        std::size_t block = 0;  // Of the two items' in the column of the lower one.
    };
    // The contacts of a group that count, summed up.
    struct Normal {
        Eigen::Matrix3d item = Eigen::Matrix3d::Zero();
        Eigen::Matrix3d other = Eigen::Matrix3d::Zero();
        Eigen::Matrix3d mixed = Eigen::Matrix3d::Zero();
        Eigen::Vector3d item_right = Eigen::Vector3d::Zero();
        Eigen::Vector3d other_right = Eigen::Vector3d::Zero();
        bool any = false;
    };

    void lay_out();
    double& cell(std::size_t item, Index row, Index column);
    double& cell(const Group& group, Index row, Index column);
    bool between_items(const Group& group) const { return contacts_[group.begin].other < items_; }
    bool at_edge(const Group& group) const {
        return edge_.push > 0.0 && contacts_[group.begin].other == items_ + 1;
    }
    Normal sum_up(const Group& group) const;
    void add(const Group& group, const Normal& sum);
    Vector newton();
    void find_slopes(const Vector& way);
    double energy(const Vector& move, const Vector& way, double share) const;

    std::size_t items_ = 0;
    const std::vector<Contact>& contacts_;
    EdgePush edge_;
    std::vector<Group> groups_;
    std::vector<std::size_t> blocks_;  // [item] Below its diagonal one.
    geometry::SymmetricMatrix matrix_;
    Vector right_;
    std::optional<geometry::SparseSolver> solver_;
    std::vector<double> short_by_;  // [contact] Of the distance it wants, after the move so far.
    std::vector<double> slope_;     // [contact] What the next step gives it.
};

}  // namespace leafcutter::fab
