// One layout of both families: each on sheets of its own material, together where they share it.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fab/job_params.h"
#include "fab/layout.h"
#include "fab/material/material.h"
#include "fab/nest/rotations.h"
#include "fab/strips/strip.h"
#include "geometry/context.h"

namespace leafcutter::fab {

struct FamilyMaterials {
    const Material& weft;
    const Material& warp;
};

// What a piece may take of a sheet, as it lies in its own frame.
struct PieceRoom {
    SheetSize size;
    Rotation rotation = Rotation::Free;
};

// The part of the largest sheet, new or of the stock, that pieces of `material` may take: without
// margins and half a kerf around. Where the material has a grain, pieces lie along it: at most
// turned over end.
// Throws Error(BadOption) if nothing is left of it or there are no sheets.
PieceRoom piece_room(const Material& material, const NestingParams& params);

// The rotations that `material` leaves of those asked for.
Rotations turns_on(const Material& material, const NestingParams& params);

// Places to try for these pieces in about `time_s` on an ordinary machine: work, not time, bounds a
// search, so that equal input gives equal layouts.
std::int64_t tries_in(double time_s, std::span<const Piece* const> pieces);

// Sheets are numbered from 1, weft first. Density counts whole sheets. Each material's pieces go
// onto a mix of what the stock has of it and of new sheets of its sizes, at the least cost; what a
// sheet leaves whole is its offcut.
//
// Throws Error(BadOption) naming what is wrong with a sheet of the stock, or a piece; Cancelled.
Layout nest_families(std::span<const Piece> pieces,
                     const FamilyMaterials& materials,
                     const NestingParams& params,
                     const geometry::Context& context = {});

}  // namespace leafcutter::fab
