// Whether an outline fits on a sheet.

#pragma once

#include "fab/job_params.h"
#include "fab/material/material.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

// True if `outline` fits into a sheet of `usable` size at an allowed rotation.
bool fits_sheet(const Ring& outline, const SheetSize& usable, Rotation rotation);

}  // namespace leafcutter::fab
