// A computation in a process of its own: whatever a mesh does to it, the daemon and the machine
// that cuts beside it go on. The child has budgets of memory and time, lower priority, and nothing
// to write to but the pipe to its parent.

#pragma once

#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "server/queue/compute_runner.h"

namespace leafcutter::server {

struct ComputeBudget {
    std::uint64_t memory_bytes = 0;  // 0: as much as there is.
    std::chrono::seconds time{0};    // 0: as long as it takes.
};

// A Compute that runs `leafcutter compute-job`, this very program, for each call. Throws
// ComputeFailed for what the child says and for a budget that is used up, ComputeCrashed if it ends
// without a word, geometry::Cancelled.
Compute compute_in_child(const ComputeBudget& budget);

// The child's whole life: takes a job from `in`, computes, answers to `out`. Returns the exit
// status.
int serve_parent(int in, int out, const ComputeBudget& budget, const Compute& compute);

}  // namespace leafcutter::server
