// The repeat of a weave's pattern.

#pragma once

#include <vector>

#include "fab/job_params.h"

namespace leafcutter::fab {

// Rows of the matrix follow rows of the grid, 1 = warp on top.
using PatternMatrix = std::vector<std::vector<int>>;

PatternMatrix pattern_matrix(const WeaveParams& params);

// Of columns: round a closed row a multiple of it lets the pattern go on.
int pattern_period(const WeaveParams& params);

}  // namespace leafcutter::fab
