// The last step of every case: from a solved chart to a foliation of one cylinder.

#pragma once

#include <string>
#include <vector>

#include "geometry/foliation.h"
#include "geometry/harmonic/bijectivity.h"
#include "geometry/harmonic/resolve.h"

namespace leafcutter::geometry {

// What a user should know about a repair that cost accuracy.
std::vector<std::string> repair_warnings(const FlipReport& repair);

// Makes the chart one-to-one and says in `warnings` what a user should know about it. `mode` and
// `graph` are left to the caller.
// Throws Error(SelfCheck, "chart-not-bijective").
Foliation finish_foliation(SolvedChart solved,
                           const std::vector<Rail>& rails,
                           const Context& context);

}  // namespace leafcutter::geometry
