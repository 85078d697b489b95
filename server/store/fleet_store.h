// The nodes that share one database, and who of them has which job or machine for how long. A
// daemon alone has no leases: what it begins is its own until it ends.

#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace leafcutter::server {

// Who uses an engine.
struct NodeScope {
    std::string node;                    // Empty: a daemon alone.
    std::chrono::milliseconds lease{0};  // Of what it takes; zero: without end.
};

// Active: takes up work. Paused, Draining: finishes what it has and begins nothing; a draining one
// is about to be shut down.
enum class NodeMode { Active, Paused, Draining };

std::string_view to_string(NodeMode mode);
std::optional<NodeMode> node_mode_named(std::string_view name);

struct NodeRecord {
    std::string id;
    std::string role;  // "all", "api", "worker", "station".
    std::string url;   // Where other nodes reach it.
    std::string version;
    NodeMode mode = NodeMode::Active;
    std::string facts_json = "{}";  // What it says of itself.
    std::int64_t started_ms = 0;
    std::int64_t seen_ms = 0;
    std::int64_t silent_ms = 0;  // Since it was last heard of.
};

struct JobLease {
    std::string job;
    std::int64_t fence = 0;
};

struct MachineLease {
    std::string device;
    std::string owner;
    std::int64_t fence = 0;
    std::int64_t left_ms = 0;  // Below zero: it is over.
};

struct Reaped {
    int jobs = 0;
    int cuts = 0;
};

class FleetStore {
public:
    virtual ~FleetStore() = default;

    // "I am here": all of the record but mode and times. Returns the mode it is wanted in.
    virtual NodeMode beat(const NodeRecord& node) = 0;

    // By id.
    virtual std::vector<NodeRecord> nodes() const = 0;

    // False: there is no such node.
    virtual bool set_mode(const std::string& id, NodeMode mode) = 0;

    // Of a node that will not come back; false if there is none.
    virtual bool forget(const std::string& id) = 0;

    // Of jobs of this node. Returns those that are its own no longer.
    virtual std::vector<std::string> renew(const std::vector<JobLease>& jobs) = 0;

    // Machines that no station has named become this one's.
    virtual void adopt_machines() = 0;

    // Takes or prolongs the leases of this station's machines; those it holds now.
    virtual std::vector<MachineLease> hold_machines() = 0;

    // Gives back all that this node holds, duties too.
    virtual void let_go_of_machines() = 0;

    // Takes or prolongs the leases of what one node does for all; those it holds now.
    virtual std::vector<std::string> hold_duties(const std::vector<std::string>& duties) = 0;

    // Who has them; the name of the duty is in `device`.
    virtual std::vector<MachineLease> duty_leases() const = 0;

    virtual std::vector<MachineLease> machine_leases() const = 0;

    // What nodes that went away had: jobs go back to the queue, cuts are interrupted and stay so
    // unless their station says otherwise, see CutStore::reclaim().
    virtual Reaped reap() = 0;
};

}  // namespace leafcutter::server
