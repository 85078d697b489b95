// What is engraved and scored on a piece: its id with an arrow, crossings, folds, the tabs' edges.
// All of it lies strictly inside the outline; what would not is left out.

#pragma once

#include <span>
#include <string>
#include <vector>

#include "fab/job_params.h"
#include "fab/strips/crossings.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

// Marks every one of `pieces`, which are those of `strips`. What had to be left out is told in
// `warnings`.
void mark_pieces(std::span<Piece> pieces,
                 std::span<const Strip> strips,
                 const Crossings& crossings,
                 const FitParams& fit,
                 std::vector<std::string>& warnings);

}  // namespace leafcutter::fab
