// First layouts on a mix of sheets: which sheets to take, and what they cost.

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "fab/nest/compaction.h"
#include "fab/nest/sheet_plan.h"
#include "geometry/context.h"

namespace leafcutter::fab {

// A layout in the coordinates of a frame.
struct SheetTrial {
    int quarters = 0;                 // Of the frame.
    std::vector<std::size_t> kinds;   // [sheet], none of them empty.
    std::vector<Position> positions;  // [item]; bin -1: found no room.
    double last_width = 0.0;          // How far the last sheet is used.
    std::size_t unplaced = 0;
    double cost = 0.0;
    double taken = 0.0;  // Area of all sheets, the last one by its used part; remnants count half.
    std::int64_t evaluations = 0;
};

// Whether `a` is worth more: more is laid, or it costs less, or it leaves more of the last sheet.
bool is_better(const SheetTrial& a, const SheetTrial& b);

// Sheets of one kind, one after the other; no count: as many as it takes.
struct SheetRun {
    std::size_t kind = 0;
    std::optional<int> count;
};

class SheetStart {
public:
    // Of the options, the seed and the work count.
    SheetStart(const SheetProblem& problem, const CompactionOptions& options);

    const SheetFrame& frame(int quarters) const { return frames_[quarters != 0 ? 1 : 0]; }

    // Lays what it can on the sheets of the runs, in their order: heaps of bands and on plain
    // rectangles, the largest item first on others. `rows`: what it may try for each heap, at least
    // one is built.
    SheetTrial lay(std::span<const SheetRun> runs,
                   int quarters,
                   std::int64_t rows,
                   const geometry::Context& context) const;

    // Whether the item fits an empty sheet of that kind if nothing of it is taken.
    bool may_fit(std::size_t item, std::size_t kind) const {
        return fits_[kind][problem_.part_of[item]] != 0;
    }

    // Leaves out empty sheets and adds up what the rest is.
    void sum_up(SheetTrial& trial) const;

private:
    struct Rest;
    void lay_heaps(const SheetRun& run, std::int64_t rows, Rest& rest, SheetTrial& trial) const;
    void lay_one_by_one(std::span<const SheetRun> runs, Rest& rest, SheetTrial& trial) const;
    bool heaps_suit(const SheetKind& kind) const { return banded_ || kind.is_plain(); }
    std::vector<SheetRun> unused(std::span<const SheetRun> runs, const SheetTrial& trial) const;

    const SheetProblem& problem_;
    std::uint64_t seed_;
    int samples_ = 0;      // Of places for an item, one by one.
    bool banded_ = false;  // Most items are long bands: those stack well in heaps.
    std::vector<SheetFrame> frames_;
    std::vector<std::vector<char>> fits_;  // [kind][part]
};

}  // namespace leafcutter::fab
