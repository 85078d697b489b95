// Measures the cells of a burnt piece: what lengths its strip brings into the weave.

#pragma once

#include <span>
#include <vector>

#include "fab/cut/audit.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

// Lengths of a cell in mm, allowances for thickness and clearance taken off.
struct CellLengths {
    double first_rung = 0.0;
    double last_rung = 0.0;
    double left = 0.0;
    double right = 0.0;
    double fold = 0.0;  // The diagonal that it is unfolded over.
};

struct MeasuredPiece {
    std::vector<CellLengths> cells;
    int ticks = 0;                      // Rung ends that a tick points at.
    int ticks_missing = 0;              // Those that have one in the plan and none on the sheet.
    double largest_tick_miss_mm = 0.0;  // Of the planned rung end from the tick's line.
    int filled_notches = 0;             // Rung ends in notches that the beam is too wide to open.
};

// `contour` is the piece's edge (kerf taken off) and `marks` what is burnt inside, both in the
// piece's own coordinates. `edge` is that edge as planned, with narrow notches filled
// (registration.h).
//
// A rung ends where its tick, made longer, meets the contour, or at the contour's corner there; a
// rung without tick at the corner or the point of the contour nearest to where it is planned. In a
// notch that stays filled, the end lies as far from the contour as it is planned to. Of
// every length between rung ends so found, the planned difference between cut and unfolded length
// is taken off: how long an allowance is, is not measured but the plan's.
MeasuredPiece measure_piece(const Piece& piece,
                            const Ring& edge,
                            const Ring& contour,
                            std::span<const BurntSegment> marks);

}  // namespace leafcutter::fab
