// Instances with bins: irregular sheets with holes and zones of quality.

#pragma once

#include <functional>

#include "fab/nest/instance.h"

namespace leafcutter::fab {

// As `solve` for instances that have bins and passed the check.
InstanceSolution solve_bins(const NestInstance& instance,
                            const CompactionOptions& options,
                            const geometry::Context& context,
                            const std::function<void(const InstanceSolution&)>& improved);

}  // namespace leafcutter::fab
