// For how long the longest-waiting ones have waited.

#pragma once

#include <cstdint>

namespace leafcutter::server {

struct QueueAges {
    std::int64_t oldest_job_ms = 0;  // Since the oldest queued job was accepted; 0: none waits.
    std::int64_t oldest_cut_ms = 0;  // Likewise of waiting cuts.
};

}  // namespace leafcutter::server
