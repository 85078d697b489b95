// Proves solutions of instances in whole numbers.

#pragma once

#include "fab/nest/instance.h"

namespace leafcutter::fab {

// Fills in what the proof finds: smallest gap, strip width, densities.
//
// Throws Error(SelfCheck) if items overlap or touch, leave their strip or bin, lie on a hole or a
// zone that is not good enough, or at a rotation that is not allowed.
void prove_solution(const NestInstance& instance, InstanceSolution& solution);

// Without its holes.
double bin_area(const InstanceBin& bin);

}  // namespace leafcutter::fab
