// Moves one band elsewhere: lays it thin onto a seam between others and lets it grow there to its
// width, while all others make room and close up where it lay.

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "fab/nest/board.h"
#include "fab/nest/compaction.h"
#include "fab/nest/pose_search.h"
#include "fab/nest/random.h"
#include "fab/nest/relaxation.h"

namespace leafcutter::fab {

class Insertion {
public:
    // At least one part must be a band.
    Insertion(const BoardPlan& plan, std::uint64_t seed);

    // What the layout becomes under a soft push: a little narrower, with small overlaps all over.
    Packing settle(const Packing& packing);

    struct Pressed {
        Packing packing;
        Packing settled;  // As of settle().
    };

    // Moves a band, picked at random, to another seam. Nothing if the layout would become wider
    // than `settled`, which comes of settle(), by more than a share of `wider`, or if it could not
    // be freed of overlaps.
    std::optional<Pressed> attempt(const Packing& settled, double wider);

    std::int64_t evaluations() const { return board_.evaluations() + relaxation_.evaluations(); }

private:
    void set_stage(std::size_t item, int stage);
    std::optional<Position> elsewhere(std::size_t item);
    bool grow(std::size_t item, const Position& at, double widest);
    Packing laid() const { return {board_.positions(), board_.extent()}; }

    BoardPlan plan_;                  // With bands of less width; which one an item is changes.
    std::vector<std::size_t> whole_;  // [item] Its part at full width.
    std::vector<std::size_t> bands_;  // Items.
    Random random_;
    Board board_;
    PoseSearch search_;
    Relaxation relaxation_;
};

}  // namespace leafcutter::fab
