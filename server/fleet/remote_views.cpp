#include "server/fleet/remote_views.h"

namespace leafcutter::server {

void RemoteViews::put(const std::string& type, const std::string& id, nlohmann::json view) {
    const Clock::time_point now = Clock::now();
    const std::scoped_lock lock(mutex_);
    for (auto entry = entries_.begin(); entry != entries_.end();) {
        entry = now - entry->second.heard > kFresh ? entries_.erase(entry) : std::next(entry);
    }
    entries_[{type, id}] = {std::move(view), now};
}

std::optional<nlohmann::json> RemoteViews::find(const std::string& type,
                                                const std::string& id) const {
    const std::scoped_lock lock(mutex_);
    const auto found = entries_.find({type, id});
    if (found == entries_.end() || Clock::now() - found->second.heard > kFresh) {
        return std::nullopt;
    }
    return found->second.view;
}

}  // namespace leafcutter::server
