// The stage of the pipeline that gives strips their thickness.

#pragma once

#include <string>
#include <vector>

#include "fab/job_result.h"
#include "geometry/context.h"

namespace leafcutter::fab {

// What is taken off each long side of a strip, mm: as the parameters say, or as the materials need.
double clearance_of(const JobResult& job);

// Sets the woven model and the report of thickness from strips, weave, crossings and pieces;
// params.fit.clearance_mm is the clearance used. Adds to `warnings` what can't be bent or passed.
void add_thickness(JobResult& job,
                   std::vector<std::string>& warnings,
                   const geometry::Context& context);

}  // namespace leafcutter::fab
