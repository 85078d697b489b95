// The daemon's way to cut single pieces again.

#pragma once

#include "server/app.h"

namespace leafcutter::server {

// See AppParts::check_recut. Throws geometry::Error; what call.read throws.
void check_job_recut(const RecutCall& call);

// See Compute: of an input that names pieces. Throws geometry::Error, geometry::Cancelled.
ComputeOutput recut_job_pieces(const ComputeInput& input, const geometry::Context& context);

}  // namespace leafcutter::server
