// Where a single part overlaps the least, all others staying where they are: random samples, the
// best of which walk downhill (section 4 of the paper named in part.h).

#pragma once

#include <cstddef>
#include <vector>

#include "fab/nest/board.h"
#include "fab/nest/random.h"

namespace leafcutter::fab {

struct Candidate {
    Position position;
    float loss = 0.0F;
};

class PoseSearch {
public:
    PoseSearch(const Board& board, Random& random) : board_(board), random_(random) {}

    // The best position found for the item; its present one at worst.
    Candidate best_for(std::size_t item);

    // Up to three positions where the item, a band that turns freely, overlaps the least, best
    // first: of `tries` beside other bands that fit it well, and some anywhere; but none where it
    // would lie mostly as it lies at `from`.
    std::vector<Candidate> beside_others(std::size_t item, int tries, const Position& from);

    // A position inside a sheet without any overlap that lies as far left and low as `samples`
    // tries find, or one that overlaps (loss > 0) if there is none.
    Candidate leftmost(std::size_t item, int samples);

private:
    static constexpr std::size_t kKept = 3;

    // A direction of a step; of a turn, the point about which.
    struct Axis {
        double x = 0.0;
        double y = 0.0;
        bool turn = false;
        Eigen::Vector2d pivot = Eigen::Vector2d::Zero();
    };
    struct Steps {
        double start = 0.0;
        double end = 0.0;
        double turn_start_deg = 0.0;
        double turn_end_deg = 0.0;
    };

    bool sample(std::size_t item, Position& position);
    void sample_near(std::size_t item, const Position& around, Position& position);
    void random_turn(const NestPart& part, Position& position);
    Eigen::Vector2d pivot(const NestPart& part);
    void consider(std::size_t item, const Position& position);
    void keep(const Candidate& candidate);
    void forget_kept(double unit);
    void descend_kept(std::size_t item, double unit);
    Axis random_axis(const NestPart& part);
    void descend(std::size_t item, Candidate& candidate, const Steps& steps);
    float loss_of(std::size_t item, const Position& position, float bound);

    const Board& board_;
    Random& random_;
    TurnedPart scratch_;
    Candidate kept_[kKept];  // NOLINT(modernize-avoid-c-arrays): best first.
    std::size_t kept_count_ = 0;
    double apart_ = 0.0;  // Candidates nearer than this are one.
};

}  // namespace leafcutter::fab
