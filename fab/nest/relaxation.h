// All parts of a board move at once until none overlap. Where a search moves one part at a time, a
// row of parts that touch each other moves here as a whole: small overlaps all over a full sheet
// are gone after a few steps, and an edge that pushes is felt on the other side.
//
// Each step solves a convex problem of linearised distances, as the compaction of Li and
// Milenkovic, "Compaction and separation algorithms for non-convex polygons and their
// applications", European Journal of Operational Research 84, 1995, but with turns, and in least
// squares.

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "fab/nest/board.h"
#include "fab/nest/contacts.h"

namespace leafcutter::fab {

class Relaxation {
public:
    explicit Relaxation(Board& board);

    // Moves what lies on the board, `steps` times at most; what jams is knocked loose `kicks` times
    // at most. True if then nothing overlaps; else the overlaps are too deep for small moves, or
    // there is no room.
    bool relax(int steps, int kicks = 0);

    // Pushes the last sheet's right edge softly against the parts as far as it goes, which leaves
    // small overlaps all over.
    void settle();

    // After settle(): frees the parts of overlaps where the edge is now, or near it. False if they
    // could not be; then nothing is known of what lies on the board.
    bool press();

    // Some steps of settle(): the edge gives way where a part has grown. By how much the least of
    // all distances was too short before the last step.
    double make_room(int steps);

    // By how much the least of all distances is too short.
    double deepest();

    // Must be called when an item has got another outline.
    void forget(std::size_t item) { contacts_.forget(item); }

    // Work so far, in what a search takes for as many places tried.
    std::int64_t evaluations() const { return evaluations_; }

private:
    void kick(const std::vector<Contact>& contacts);
    const std::vector<Contact>& find();
    void apply(const Eigen::VectorXd& move);
    double push_once(double push);
    void push_until_it_rests(double push);

    Board& board_;
    Contacts contacts_;
    double trust_ = 0.0;  // By which the edge moves in a step.
    std::int64_t evaluations_ = 0;
};

}  // namespace leafcutter::fab
