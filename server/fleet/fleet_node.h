// This process as a member of a fleet: says that it lives, keeps the leases of its jobs and
// machines, tells the others what passes here, and, where clients are served, notices whom the
// fleet has lost.

#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "server/fleet/node_role.h"
#include "server/queue/compute_runner.h"
#include "server/queue/device_fleet.h"
#include "server/store/store.h"

namespace leafcutter::server {

struct FleetSelf {
    std::string id;
    NodeRole role = NodeRole::All;
    std::string url;
    std::chrono::milliseconds lease{30000};
};

struct FleetHooks {
    // What others should know of a job, cut or device here, as JSON text; nothing: it is gone.
    std::function<std::optional<std::string>(const std::string& type, const std::string& id)> view;

    // Called with every heartbeat: what else has to be looked at again and again.
    std::function<void()> on_beat;
};

class FleetNode {
public:
    FleetNode(Store& store,
              ComputeRunner& compute,
              DeviceFleet& devices,
              FleetSelf self,
              FleetHooks hooks);
    ~FleetNode();
    FleetNode(const FleetNode&) = delete;
    FleetNode& operator=(const FleetNode&) = delete;

    // Rows changed somewhere. Any thread; never waits.
    void wake();

    // Something passed here that others want to see. Any thread; never waits.
    void post(const std::string& type, const std::string& id);

    // From now on its machines begin nothing; leases are kept.
    void begin_nothing() { closing_ = true; }

    const FleetSelf& self() const { return self_; }

private:
    using Clock = std::chrono::steady_clock;

    void loop(const std::stop_token& stop);
    void beat();
    void keep_jobs();
    void keep_machines(NodeMode mode);
    void disarm(const std::string& device);
    void reconcile_cuts();
    void reap_if_sure();
    void tell_others();
    NodeRecord record() const;

    Store& store_;
    ComputeRunner& compute_;
    DeviceFleet& devices_;
    const FleetSelf self_;
    const FleetHooks hooks_;
    std::atomic<bool> closing_{false};

    // Of the loop's thread alone.
    Clock::time_point next_beat_{};
    NodeMode mode_ = NodeMode::Active;  // As it was last told.
    std::optional<Clock::time_point> reachable_since_;
    Clock::time_point last_contact_{};  // The last heartbeat's end.
    std::int64_t database_ms_ = 0;      // How long the last heartbeat took to be on disk.

    std::mutex mutex_;  // Guards the members below.
    std::condition_variable_any nudged_;
    bool woken_ = false;
    std::set<std::pair<std::string, std::string>> passing_;

    std::jthread thread_;  // Last: it uses everything above.
};

}  // namespace leafcutter::server
