// What a process does in a fleet, and how far its release may be from the others'.

#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace leafcutter::server {

// Every node answers requests; all computes and cuts too, the others do one of the three.
enum class NodeRole { All, Api, Worker, Station };

std::string_view to_string(NodeRole role);
std::optional<NodeRole> node_role_named(std::string_view name);

constexpr bool computes(NodeRole role) {
    return role == NodeRole::All || role == NodeRole::Worker;
}
constexpr bool cuts(NodeRole role) {
    return role == NodeRole::All || role == NodeRole::Station;
}
// Clients are sent there, files are kept there, and lost leases are noticed there.
constexpr bool serves(NodeRole role) {
    return role == NodeRole::All || role == NodeRole::Api;
}

// "1.4.2" and "1.5.0" are neighbours, as are a release and itself; "1.4.2" and "1.6.0" are not, nor
// is what has another first number or can't be read.
bool may_work_together(std::string_view version, std::string_view other);

}  // namespace leafcutter::server
