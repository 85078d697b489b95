// The foliation section of the job parameters.

#pragma once

#include "fab/job_params.h"
#include "server/json_reader.h"

namespace leafcutter::server {

// What is absent keeps its value. Refuses by full path what is wrong in itself and what can't mean
// anything together; what fits the model is known only when the model is.
void read_foliation(ObjectReader& reader, fab::FoliationParams& foliation);

}  // namespace leafcutter::server
