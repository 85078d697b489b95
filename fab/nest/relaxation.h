// All parts of a board move at once until none overlap. Where a search moves one part at a time, a
// row of parts that touch each other moves here as a whole: small overlaps all over a full sheet
// are gone after a few steps, and an edge that pushes is felt on the other side.
//
// Each step solves a convex problem of linearised distances, as the compaction of Li and
// Milenkovic, "Compaction and separation algorithms for non-convex polygons and their
// applications", European Journal of Operational Research 84, 1995, but with turns, and in least
// squares.

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "fab/nest/board.h"

namespace leafcutter::fab {

class Relaxation {
public:
    explicit Relaxation(Board& board);

    // Moves what lies on the board, `steps` times at most. True if then nothing overlaps; else the
    // overlaps are too deep for small moves, or there is no room.
    bool relax(int steps);

    // Pushes the last sheet's right edge against the parts as far as it goes. True if then the
    // sheet is narrower and nothing overlaps; else nothing is known of what lies on the board.
    bool press();

    // Work so far, in what a search takes for as many places tried.
    std::int64_t evaluations() const { return evaluations_; }

private:
    // A vertex of a part and the nearest point of what it must not enter.
    struct Contact {
        std::size_t item = 0;
        std::size_t other = 0;                                 // An item, or one of the two below.
        Eigen::Vector3d item_gain = Eigen::Vector3d::Zero();   // Of distance by x, y and turn.
        Eigen::Vector3d other_gain = Eigen::Vector3d::Zero();  // Likewise of the other's.
        double want = 0.0;  // By how much the distance must grow.
    };
    // The contacts of two that touch, summed up.
    struct Normal {
        Eigen::Matrix3d item = Eigen::Matrix3d::Zero();
        Eigen::Matrix3d other = Eigen::Matrix3d::Zero();
        Eigen::Matrix3d mixed = Eigen::Matrix3d::Zero();
        Eigen::Vector3d item_right = Eigen::Vector3d::Zero();
        Eigen::Vector3d other_right = Eigen::Vector3d::Zero();
        bool any = false;
    };
    using Vector = Eigen::VectorXd;

    std::size_t still() const { return board_.items(); }     // What does not move.
    std::size_t edge() const { return board_.items() + 1; }  // The last sheet's right edge.
    double reach(std::size_t item) const;
    void collect();
    void collect_walls(std::size_t item);
    void collect_pair(std::size_t item, std::size_t other);
    void collect_fixed(std::size_t item);
    double deepest() const;

    double short_by(const Contact& contact, const Vector& move) const;
    double energy(const Vector& move) const;
    Normal sum_up(std::size_t& contact, const Vector& move) const;
    Vector newton(const Vector& move) const;
    Vector solve() const;
    void apply(const Vector& move);
    void push_until_it_rests(double push);

    Board& board_;
    double clearance_ = 0.0;    // Between parts that do not overlap.
    double trust_ = 0.0;        // By which the edge moves in a step.
    double push_ = 0.0;         // Of the edge; 0: it stays.
    std::vector<double> turn_;  // [item] Radians for each unit of a move.
    std::vector<Contact> contacts_;
    std::int64_t evaluations_ = 0;
};

}  // namespace leafcutter::fab
