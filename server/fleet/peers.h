// The other nodes of a fleet over HTTP: files by their SHA-256, and calls that only the station of
// a machine can answer. Safe from any thread.

#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/store/blobs.h"
#include "server/store/fleet_store.h"

namespace leafcutter::server {

// Names the caller's headers between nodes; believed only with the fleet's key.
constexpr const char* kCallerHeader = "X-Leafcutter-Caller";
constexpr const char* kRoleHeader = "X-Leafcutter-Role";
constexpr const char* kMayFireHeader = "X-Leafcutter-May-Fire";

struct PeerCall {
    std::string method;
    std::string path;  // With the query, as on the wire.
    std::string body;
    std::string caller;
    std::string role;
    bool may_fire = false;
    std::map<std::string, std::string> headers = {};
};

struct PeerAnswer {
    int status = 0;
    std::string content_type;
    std::string body;
    std::string etag;
};

class Peers {
public:
    // `node` is this one. Nodes that were silent for `patience` are not asked.
    Peers(std::string node, std::string key, std::chrono::milliseconds patience)
        : node_(std::move(node)), key_(std::move(key)), patience_(patience) {}

    // Before that there is nobody to ask.
    void know(const FleetStore& fleet) { fleet_ = &fleet; }

    const std::string& key() const { return key_; }

    // Gets the blob from whoever has it and keeps it. False: nobody does.
    bool fetch(const std::string& sha256, const Blobs& blobs) const;

    // Puts the blob onto one node that serves clients; false: none took it.
    bool share(const std::string& sha256, const Blobs& blobs) const;

    // Nothing: the node does not answer.
    std::optional<PeerAnswer> call(const NodeRecord& node, const PeerCall& call) const;

    // A node that was heard of lately.
    std::optional<NodeRecord> living(const std::string& id) const;

private:
    // Those that serve clients first; without this one.
    std::vector<NodeRecord> others() const;

    const std::string node_;
    const std::string key_;
    const std::chrono::milliseconds patience_;
    const FleetStore* fleet_ = nullptr;
};

}  // namespace leafcutter::server
