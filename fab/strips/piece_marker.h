// Marks one piece.

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fab/job_params.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

// What a piece's marks tell, besides its own shape. Cells are counted from the piece's first.
struct MarkFacts {
    std::vector<std::string_view> crossing;  // Id of the strip that crosses, per cell.
    std::vector<int> numbers;                // Its number.
    std::vector<char> under;                 // The cell lies under it.
    std::string before;                      // The piece that the start is joined to, or empty,
    std::string behind;                      // and the one at the end.
};

struct PieceMarks {
    std::vector<Mark> marks;
    bool is_named = true;
    int bare_rungs = 0;        // Without ticks for want of room,
    int bare_weave_cells = 0;  // under cells without a bar.
};

PieceMarks marks_of(const Piece& piece, const MarkFacts& facts, const FitParams& fit);

}  // namespace leafcutter::fab
