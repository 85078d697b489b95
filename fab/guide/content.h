// The assembly guide of a job: everything that someone needs who has a pile of strips and has never
// seen the shape.

#pragma once

#include "fab/guide/document.h"
#include "fab/job_result.h"

namespace leafcutter::fab::guide {

Document make_guide(const JobResult& job);

}  // namespace leafcutter::fab::guide
