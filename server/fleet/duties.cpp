#include "server/fleet/duties.h"

#include <vector>

#include "server/store/fleet_store.h"

namespace leafcutter::server {

void Duties::want(const std::string& duty) {
    const std::scoped_lock lock(mutex_);
    held_until_.try_emplace(duty);
}

bool Duties::has(const std::string& duty) const {
    if (lease_.count() == 0) {
        return true;
    }
    const std::scoped_lock lock(mutex_);
    const auto found = held_until_.find(duty);
    return found != held_until_.end() && Clock::now() < found->second;
}

void Duties::renew(FleetStore& fleet) {
    std::vector<std::string> wanted;
    {
        const std::scoped_lock lock(mutex_);
        for (const auto& [duty, until] : held_until_) {
            wanted.push_back(duty);
        }
    }
    if (wanted.empty()) {
        return;
    }
    // The database counts from later: a node that was frozen knows before the others that it may
    // not go on.
    const Clock::time_point until = Clock::now() + lease_;
    const std::vector<std::string> held = fleet.hold_duties(wanted);
    const std::scoped_lock lock(mutex_);
    for (const std::string& duty : held) {
        held_until_[duty] = until;
    }
}

}  // namespace leafcutter::server
