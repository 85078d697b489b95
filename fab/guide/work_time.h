// How long hands take to put a job's strips together.

#pragma once

#include "fab/job_result.h"

namespace leafcutter::fab::guide {

// What a practised hand takes, in seconds. Rules of thumb.
struct HandTimes {
    double per_piece = 15.0;    // To take it out, find its place and fold its scores.
    double per_crossing = 3.0;  // To lay one strip over or under another.
    double per_threaded = 8.0;  // More, where it is pushed through.
    double per_joint = 40.0;    // To glue a tab and hold it.
};

double working_time_s(const JobResult& job, const HandTimes& times = {});

}  // namespace leafcutter::fab::guide
