// From the exact unfolding of a piece to the outline that is cut: crimp, clearance, glue tab.
//
// Crimp: a thread that goes from over to under its crossing threads climbs by the material's
// thickness t within a cell of length L; it is given sqrt(L² + t²) instead of L (at most kMaxCrimp
// more), each cell stretched along its centre line, so that rungs keep their length and direction.
//
// Clearance: both ends of every rung move inward by the clearance, measured across the strip's
// side, but never below the material's least width.

#pragma once

#include "fab/strips/strip.h"
#include "fab/strips/unfold.h"

namespace leafcutter::fab {

constexpr double kMaxCrimp = 0.1;

struct FitOptions {
    double clearance_mm = 0.0;
    double crimp_thickness_mm = 0.0;  // 0: no crimp.
    double min_width_mm = 0.0;
    double tab_mm = 0.0;  // 0: no tab.
};

struct Fitted {
    Polyline left;  // Rung ends on the outline, one more than cells.
    Polyline right;
    Ring outline;  // Snapped (overlap.h); may overlap itself: that is the caller's to test.
    double length_mm = 0.0;  // Of the centre line, with tab.
    int narrow_rungs = 0;    // Narrower than the least width before any clearance.
};

// `flat` holds the piece's `cell_count` cells and behind them those that its tab lies on.
Fitted fit_piece(const Unfolded& flat, int cell_count, const FitOptions& options);

}  // namespace leafcutter::fab
