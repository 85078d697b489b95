// One layout of both families: each on sheets of its own material, together where they share it.

#pragma once

#include <span>

#include "fab/job_params.h"
#include "fab/layout.h"
#include "fab/material/material.h"
#include "fab/strips/strip.h"
#include "geometry/context.h"

namespace leafcutter::fab {

struct FamilyMaterials {
    const Material& weft;
    const Material& warp;
};

// The part of a sheet of `material` that pieces may take: without margins and half a kerf around.
// Throws Error(BadOption) if nothing is left of it or the material has no sheets.
SheetSize usable_sheet(const Material& material, const NestingParams& params);

// Sheets are numbered from 1, weft first. Density counts whole sheets.
Layout nest_families(std::span<const Piece> pieces,
                     const FamilyMaterials& materials,
                     const NestingParams& params,
                     const geometry::Context& context = {});

}  // namespace leafcutter::fab
