// Places pieces on sheets without overlap: rectangles of several sizes and remnants of any outline,
// as many of each as there are.
//
// Equal pieces, sheets, options and seed give equal output, whatever the number of threads, unless
// `time_s` ends the search. A stop request ends it with the best layout so far.

#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "fab/job_params.h"
#include "fab/layout.h"
#include "fab/material/stock.h"
#include "fab/nest/rotations.h"
#include "geometry/context.h"

namespace leafcutter::fab {

struct NestOptions {
    double spacing_mm = 1.0;  // Between two outlines, after kerf.
    double margin_mm = 5.0;   // From the sheet's edge, after kerf.
    double kerf_mm = 0.0;
    Rotation rotation = Rotation::Free;
    Rotations turns = {};  // Instead of `rotation`, unless any.
    std::map<std::string, Rotations, std::less<>> piece_turns = {};  // By id, instead of both.
    std::uint32_t seed = 1;
    std::int64_t max_evaluations = 400'000;  // Places tried for a piece.
    double time_s = 0.0;  // By the context's clock, from the first layout on; 0: no limit.
};

// Nests `pieces` on sheets of `stock`: all pieces if they fit, then at the least cost, then with as
// much as possible of the last sheet whole. Sheet ids count from 1. Every layout returned is
// proven: no two outlines closer than spacing + kerf, none outside the margin or on a hole, defect
// or zone to keep out of. Pieces that find no room are the layout's `unplaced`.
//
// Throws Error(BadOption) for a sheet smaller than its margins, an outline that is no simple
// polygon or an id that is there twice, naming piece or sheet; Cancelled if stopped before there is
// a layout.
Layout nest(std::span<const Piece* const> pieces,
            std::span<const StockItem> stock,
            const NestOptions& options,
            const geometry::Context& context = {});

// On as many sheets of `size` as it takes.
Layout nest(std::span<const Piece* const> pieces,
            const SheetSize& size,
            const NestOptions& options,
            const geometry::Context& context = {});

// Of a sheet: its outline's, holes left in.
double sheet_area_mm2(const Sheet& sheet);

}  // namespace leafcutter::fab
