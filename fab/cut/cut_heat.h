// How hot a sheet is where the beam cuts.
//
// Each mm of cut leaves heat that spreads over `reach_mm` and decays with `decay_s`:
//   Q(x, t) = Σ ds / (√(2π) reach) · exp(−(t − t_i) / decay) · exp(−d² / 2 reach²)
// so that Q is 1 on a long straight line that has just been cut. The heat index of a path is the
// largest Q that other paths have left where and when the beam comes by.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "fab/cut/cut_program.h"
#include "geometry/context.h"

namespace leafcutter::fab {

struct HeatOptions {
    double decay_s = 8.0;
    double reach_mm = 5.0;
    double burn_mm_per_s = 15.0;
    double travel_mm_per_s = 100.0;
};

// What a material's sheet does: it loses its heat through both faces to the air.
HeatOptions cooling_of(const Material& material, const MachineProfile& machine);

}  // namespace leafcutter::fab
