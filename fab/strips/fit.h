// From the exact unfolding of a piece to the outline that is cut: crimp, clearance, least width,
// tabs.
//
// Crimp: a thread that goes over and under its crossing threads is longer than the middle of its
// cells; each cell is stretched along its centre line by its allowance, so that rungs keep their
// length and direction.
//
// Clearance: both ends of every rung move inward by the clearance, measured across the strip's
// side, but never below the material's least width. Where the exact cell is narrower than that, the
// rung is widened: evenly on both sides, where the strip turns on the outer side only, so that the
// inner side doesn't fold over.

#pragma once

#include <vector>

#include "fab/strips/strip.h"
#include "fab/strips/tabs.h"
#include "fab/strips/unfold.h"

namespace leafcutter::fab {

// A cell is never made longer than by this part.
constexpr double kMaxCrimp = 0.1;

enum class Widening { OuterSide, BothSides, None };

struct FitOptions {
    double clearance_mm = 0.0;
    double min_width_mm = 0.0;
    Widening widening = Widening::OuterSide;
    std::vector<double>
        extra_mm;               // Per cell of the unfolding, with those under tabs; may be empty.
    double start_tab_mm = 0.0;  // 0: no tab. At most as long as the cells there.
    double end_tab_mm = 0.0;
    bool arrow = false;  // The end's tab is an arrow if it is wide enough.
};

// How narrow the exact strip is, measured across it.
struct NarrowPlaces {
    double least_mm = 0.0;     // The narrowest rung.
    double widened_mm = 0.0;   // The most that a rung was made wider.
    double hopeless_mm = 0.0;  // Length along the middle where it is below a fifth of the least.
};

struct Fitted {
    Polyline left;  // Rung ends on the outline, one more than cells.
    Polyline right;
    Ring outline;  // Snapped (overlap.h); may overlap itself: that is the caller's to test.
    double length_mm = 0.0;     // Of the centre line, with tabs,
    double between_mm = 0.0;    // and without.
    double start_tab_mm = 0.0;  // As they came out.
    double end_tab_mm = 0.0;
    std::optional<Arrow> arrow;
    NarrowPlaces narrow;
};

// `cells`: those of the piece in `flat`; before and behind them lie those under its tabs.
Fitted fit_piece(const Unfolded& flat, const CellRun& cells, const FitOptions& options);

}  // namespace leafcutter::fab
