// A band laid alongside another one of the same sheet: a stretch of its middle line follows the
// other's, half of both widths to the side, as well as least squares can.

#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "fab/nest/board.h"
#include "fab/nest/random.h"

namespace leafcutter::fab {

struct Mate {
    std::size_t item = 0;
    std::size_t other = 0;
    double overlap = 0.0;  // Length of the stretch.
    double misfit = 0.0;   // Root mean square of how far it lies from where it should.
    // The item's point `from` goes to `to` in the other's frame, turned by this cosine and sine.
    Eigen::Vector2d turn = Eigen::Vector2d::UnitX();
    Eigen::Vector2d from = Eigen::Vector2d::Zero();
    Eigen::Vector2d to = Eigen::Vector2d::Zero();
};

// Beside an item picked at random, at a random stretch. Nothing if that is no other band.
std::optional<Mate> random_mate(const BoardPlan& plan, std::size_t item, Random& random);

// That of `tries` which fits best for its length. Nothing if none was beside another band.
std::optional<Mate> best_mate(const BoardPlan& plan, std::size_t item, int tries, Random& random);

// Whether most of a band at one place would lie where it lies at the other.
bool is_same_place(const NestPart& band, const Position& one, const Position& other);

// Where it lies if the other stays; turned to the nearest rotation that its part allows.
Position mated(const Board& board, const Mate& mate);

}  // namespace leafcutter::fab
