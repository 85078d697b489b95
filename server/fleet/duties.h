// What one node of a fleet does for all of them, such as letting old jobs go: each duty is held, by
// a lease, by one of the nodes that want it. Safe from any thread.

#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <string>

namespace leafcutter::server {

class FleetStore;

constexpr const char* kHousekeeping = "housekeeping";

class Duties {
public:
    // `lease` of zero: a daemon alone, whose every duty is.
    explicit Duties(std::chrono::milliseconds lease) : lease_(lease) {}

    // From the next renewal on; one that another node has is waited for.
    void want(const std::string& duty);

    // It is this node's, and stays so for a moment.
    bool has(const std::string& duty) const;

    // With every heartbeat. Throws StoreError.
    void renew(FleetStore& fleet);

private:
    using Clock = std::chrono::steady_clock;

    const std::chrono::milliseconds lease_;
    mutable std::mutex mutex_;                             // Guards held_until_.
    std::map<std::string, Clock::time_point> held_until_;  // Of all that are wanted.
};

}  // namespace leafcutter::server
