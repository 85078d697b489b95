#include "server/fleet/node_role.h"

#include <array>
#include <charconv>
#include <cstdlib>
#include <utility>

namespace leafcutter::server {

namespace {

constexpr std::array<std::pair<NodeRole, std::string_view>, 4> kNames{
    {{NodeRole::All, "all"},
     {NodeRole::Api, "api"},
     {NodeRole::Worker, "worker"},
     {NodeRole::Station, "station"}}};

// The first two numbers of a version.
std::optional<std::pair<int, int>> release_of(std::string_view version) {
    int major = 0;
    int minor = 0;
    const char* const end = version.data() + version.size();
    const auto first = std::from_chars(version.data(), end, major);
    if (first.ec != std::errc() || first.ptr == end || *first.ptr != '.') {
        return std::nullopt;
    }
    const auto second = std::from_chars(first.ptr + 1, end, minor);
    return second.ec == std::errc() ? std::optional(std::pair(major, minor)) : std::nullopt;
}

}  // namespace

std::string_view to_string(NodeRole role) {
    for (const auto& [candidate, name] : kNames) {
        if (candidate == role) {
            return name;
        }
    }
    return "all";
}

std::optional<NodeRole> node_role_named(std::string_view name) {
    for (const auto& [role, candidate] : kNames) {
        if (candidate == name) {
            return role;
        }
    }
    return std::nullopt;
}

bool may_work_together(std::string_view version, std::string_view other) {
    const auto one = release_of(version);
    const auto two = release_of(other);
    return one && two && one->first == two->first && std::abs(one->second - two->second) <= 1;
}

}  // namespace leafcutter::server
