// What is engraved and scored on a piece: its id with an arrow, crossings, folds, the tab's edge.
// All of it lies strictly inside the outline; what would not is left out.

#pragma once

#include <string>
#include <vector>

#include "fab/fit.h"
#include "fab/job_params.h"
#include "fab/strip.h"
#include "fab/unfold.h"

namespace leafcutter::fab {

struct MarkSource {
    const std::string& text;
    const Fitted& fitted;
    const Unfolded& flat;                  // At least the piece's cells.
    const std::vector<WalkedCell>& cells;  // The strip's.
    CellRun run;                           // The piece's cells.
    bool has_tab = false;
};

struct Marks {
    std::vector<Mark> marks;
    bool label_fits = true;
};

Marks make_marks(const MarkSource& source, const FitParams& fit);

}  // namespace leafcutter::fab
