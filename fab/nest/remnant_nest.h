// Pieces on what is left of a sheet, whatever its outline.

#pragma once

#include <span>

#include "fab/job_params.h"
#include "fab/layout.h"
#include "fab/material/material.h"
#include "fab/strips/strip.h"
#include "geometry/context.h"

namespace leafcutter::fab {

// One sheet: `outline` moved so that its bounds start at the origin. Spacing, margin and kerf hold
// as on whole sheets, and are proven. Pieces that find no room are the layout's `unplaced`.
//
// Throws Error(BadOption) for an outline that is no simple polygon or that margins leave nothing
// of; Cancelled.
Layout nest_remnant(std::span<const Piece* const> pieces,
                    const Material& material,
                    const Ring& outline,
                    const NestingParams& params,
                    const geometry::Context& context = {});

}  // namespace leafcutter::fab
