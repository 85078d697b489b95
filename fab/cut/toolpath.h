// From a nested sheet to a cut program: kerf offset, text to strokes, order of cutting, times.

#pragma once

#include <span>

#include "fab/cut/cut_program.h"
#include "fab/layout.h"
#include "geometry/context.h"

namespace leafcutter::fab {

// `pieces` holds at least the pieces placed on `sheet`. Cut contours are offset outward by half the
// material's kerf; nothing is cut twice, nothing left uncut.
CutProgram plan_sheet(const Sheet& sheet,
                      std::span<const Piece> pieces,
                      const Material& material,
                      const MachineProfile& machine,
                      const geometry::Context& context = {});

}  // namespace leafcutter::fab
