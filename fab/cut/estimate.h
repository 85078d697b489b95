// How far and how long a machine travels for a cut program.

#pragma once

#include "fab/cut/cut_program.h"

namespace leafcutter::fab {

struct CutEstimate {
    double burn_mm = 0.0;    // Every pass counted.
    double travel_mm = 0.0;  // With the beam off, from and back to the origin.
    double seconds = 0.0;
};

// Trapezoidal speeds with look-ahead over the whole program; corners are taken at the speed that a
// junction deviation of 0.01 mm allows, as GRBL's planner does.
CutEstimate estimate_cut(const CutProgram& program, const MachineProfile& machine);

}  // namespace leafcutter::fab
