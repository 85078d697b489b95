// The daemon's way to cut single pieces again.

#pragma once

#include "server/app.h"

namespace leafcutter::server {

// See AppParts::recut. Throws geometry::Error; what call.read throws.
ComputeOutput recut_job_pieces(const RecutCall& call);

}  // namespace leafcutter::server
