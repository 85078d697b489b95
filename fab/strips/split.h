// Where strips are opened and parted, so that every piece is one simple outline that fits its
// sheet, and so that its joints show as little as can be.

#pragma once

#include <span>
#include <vector>

#include "fab/job_params.h"
#include "fab/material/material.h"
#include "fab/strips/crossings.h"
#include "fab/strips/fit.h"
#include "fab/strips/joints.h"
#include "fab/strips/strip.h"
#include "fab/strips/unfold.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

struct SplitOptions {
    double clearance_mm = 0.0;
    double min_width_mm = 0.0;
    double min_length_mm = 0.0;
    std::vector<double> extra_mm;  // Crimp allowance per cell of the strip; may be empty.
    Joint joint = Joint::Glue;
    double tab_mm = 0.0;
    SheetSize usable_sheet;
    Rotation rotation = Rotation::Free;
    double max_piece_mm = 900.0;
    double self_gap_mm = 0.5;
};

// A piece with its unfolding, which goes on over the cells under the tabs.
struct CutPiece {
    CellRun run;     // Into the strip's cells.
    Unfolded flat;   // Of more cells: those before and behind are under tabs.
    int before = 0;  // Cells of `flat` before the piece's first.
    Fitted fitted;
    bool fits_sheet = true;
    bool widened = true;  // No rung is narrower than the least width.
};

struct Parting {
    std::vector<CutPiece> pieces;
    int overlaps = 0;  // Partings made because the strip would have lain on itself.
};

struct StripPlaces {
    std::span<const Crossing> crossings;     // Of the strip, per cell; may be empty.
    const JointMap* joints = nullptr;        // Those made before; may be null.
    std::span<const double> threading = {};  // Per cell what a joint before it costs in threading
                                             // (opening_costs); may be empty.
    std::span<const int> windings = {};      // Cells before which it has to be parted.
};

// Parts `strip` into the fewest pieces that are good, where the joints show least. `cells` are
// those of walk_cells.
Parting part_strip(const geometry::QuadMesh& mesh,
                   const std::vector<WalkedCell>& cells,
                   const Strip& strip,
                   const StripPlaces& places,
                   const SplitOptions& options);

}  // namespace leafcutter::fab
