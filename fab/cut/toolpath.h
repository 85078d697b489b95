// From a nested sheet to a cut program: kerf offset, text to strokes, bridges,
// lead-ins, order of cutting, times.

#pragma once

#include <span>

#include "fab/cut/cut_program.h"
#include "fab/job_params.h"
#include "fab/layout.h"
#include "geometry/context.h"

namespace leafcutter::fab {

struct CutSetup {
    Material material;
    MachineProfile machine = {};
    CutParams wishes = {};
};

// `pieces` holds at least the pieces placed on `sheet`. Cut contours are offset outward by half the
// material's kerf; nothing is cut twice but what over-cuts repeat, nothing left uncut but tabs.
CutProgram plan_sheet(const Sheet& sheet,
                      std::span<const Piece> pieces,
                      const CutSetup& setup,
                      const geometry::Context& context = {});

// How far a contour is cut past its start, so that the piece drops out: nothing in sheets thinner
// than 1 mm, a quarter of the thickness in others, 1 mm at most.
double usual_over_cut_mm(const Material& material);

}  // namespace leafcutter::fab
