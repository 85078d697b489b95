// Places pieces on as many sheets as needed, without overlap.
//
// Equal pieces, options and seed give equal output, whatever the number of threads, unless
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

// Nests `pieces` on sheets of `size`; sheet ids count from 1. Every layout returned is
// proven: no two outlines closer than spacing + kerf, none outside the margin.
//
// Throws Error(BadOption) for a sheet smaller than its margins or an outline that is no simple
// polygon, naming the piece; Cancelled if stopped before there is a layout.
Layout nest(std::span<const Piece* const> pieces,
            const SheetSize& size,
            const NestOptions& options,
            const geometry::Context& context = {});

}  // namespace leafcutter::fab
