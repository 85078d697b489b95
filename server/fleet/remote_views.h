// What other nodes said lately of their machines, cuts and jobs in work. Nobody keeps it: a node
// says it again and again while it lives. Safe from any thread.

#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

namespace leafcutter::server {

class RemoteViews {
public:
    static constexpr std::chrono::seconds kFresh{10};

    // Of `type` "device", "cut" or "job".
    void put(const std::string& type, const std::string& id, nlohmann::json view);

    // Nothing if nobody said anything within kFresh.
    std::optional<nlohmann::json> find(const std::string& type, const std::string& id) const;

private:
    using Clock = std::chrono::steady_clock;

    struct Entry {
        nlohmann::json view;
        Clock::time_point heard;
    };

    mutable std::mutex mutex_;  // Guards entries_.
    std::map<std::pair<std::string, std::string>, Entry> entries_;
};

}  // namespace leafcutter::server
