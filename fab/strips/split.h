// Where strips are opened and parted, so that every piece is one simple outline that fits its
// sheet.

#pragma once

#include <vector>

#include "fab/job_params.h"
#include "fab/material/material.h"
#include "fab/strips/fit.h"
#include "fab/strips/strip.h"
#include "fab/strips/unfold.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

struct SplitOptions {
    FitOptions fit;
    SheetSize usable_sheet;
    Rotation rotation = Rotation::Free;
    double max_piece_mm = 900.0;
    double self_gap_mm = 0.5;
};

// A piece with its unfolding, which goes on over the cells under the tab.
struct CutPiece {
    CellRun run;
    Unfolded flat;
    Fitted fitted;
    bool has_tab = false;
    bool fits_sheet = true;
};

struct Parting {
    std::vector<CutPiece> pieces;
    int overlaps = 0;  // Partings made because the strip would have lain on itself.
};

// The cell before which a closed strip is opened: where its middle line turns least. Among equals
// `ordinal` chooses, so that the joints of neighbouring strips don't line up.
int opening_cell(const Unfolded& whole, int cell_count, int ordinal);

// True if `outline` fits into a sheet of `usable` size at an allowed rotation.
bool fits_sheet(const Ring& outline, const SheetSize& usable, Rotation rotation);

// Parts `strip` greedily: each piece is as long as length, sheet and its own shape allow, then all
// are made about equally long if that takes no more pieces.
Parting part_strip(const geometry::QuadMesh& mesh,
                   const std::vector<WalkedCell>& cells,
                   const Strip& strip,
                   const SplitOptions& options);

}  // namespace leafcutter::fab
