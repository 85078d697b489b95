// The order of assembly as a stage of a job.

#pragma once

#include <string>
#include <vector>

#include "fab/job_result.h"

namespace leafcutter::fab {

// Plans the order from the job's quads, strips, pieces and crossings, and checks it. What hands
// will find hard is told in `warnings`. Throws Error(SelfCheck) if a move turns out to be
// impossible.
void add_assembly(JobResult& job, std::vector<std::string>& warnings);

}  // namespace leafcutter::fab
