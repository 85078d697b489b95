// Drives overlaps to nothing: passes of moves under weights that learn which overlaps are hard
// (algorithm "separate" of the paper named in part.h).

#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "fab/nest/board.h"
#include "fab/nest/pose_search.h"
#include "fab/nest/random.h"

namespace leafcutter::fab {

struct SeparationLimits {
    int strikes = 3;  // Rounds without a gain of 2 % before it gives up.
    int idle = 200;   // Passes of a round without such a gain.
};

class Separation {
public:
    enum class State { Working, Feasible, GaveUp };

    Separation(Board& board, Random& random)
        : board_(board), random_(random), search_(board, random) {}

    // Starts from what lies on the board.
    void begin(const SeparationLimits& limits);

    // Moves overlapping items, pass after pass, until it is decided or the board has made
    // `evaluations`; goes on where it left off. Throws Cancelled after a stop request.
    State run(std::int64_t evaluations, const std::stop_token& stop);

    // The layout of the least overlap since begin().
    const std::vector<Position>& best() const { return best_; }
    double best_loss() const { return best_loss_; }

private:
    void line_up();
    bool move_next(const std::stop_token& stop);
    State end_pass();

    Board& board_;
    Random& random_;
    PoseSearch search_;
    SeparationLimits limits_;
    std::vector<PoseClash> clashes_;
    std::vector<std::size_t> queue_;  // Items of this pass that wait for their move, last first.
    std::vector<Position> best_;
    double best_loss_ = 0.0;
    double round_loss_ = 0.0;
    int idle_ = 0;
    int strikes_ = 0;
};

}  // namespace leafcutter::fab
