// The daemon's computation: job parameters as JSON, the pipeline, and what the job says of its
// sheets.

#pragma once

#include <string>
#include <vector>

#include "server/queue/compute_runner.h"

namespace leafcutter::server {

// The sheets that the package's own report lists: one program each, numbered across materials.
std::vector<SheetPlan> sheets_in(const fab::Package& package);

// See Compute. Throws geometry::Error, geometry::Cancelled.
ComputeOutput weave_job(const ComputeInput& input, const geometry::Context& context);

// Throws geometry::Error for parameters that weave_job would refuse unseen.
void check_job_params(const std::string& params_json);

}  // namespace leafcutter::server
