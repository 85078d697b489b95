#include "server/auth/login_limit.h"

#include <algorithm>

namespace leafcutter::server {

std::chrono::seconds LoginLimit::try_now(const std::string& key, Clock::time_point now) {
    const std::scoped_lock lock(mutex_);
    Tries& tries = tries_[key];
    if (tries.count > 0 && now - tries.last > kLongestWait) {
        tries = {};
    }
    if (now < tries.next) {
        return std::chrono::ceil<std::chrono::seconds>(tries.next - now);
    }
    tries.last = now;
    if (++tries.count >= kFreeTries) {
        constexpr int kMostDoublings = 8;
        const int doublings = std::min(tries.count - kFreeTries, kMostDoublings);
        tries.next =
            now + std::min<std::chrono::seconds>(kFirstWait * (1 << doublings), kLongestWait);
    }
    if (tries_.size() > kMostKeys) {
        forget_oldest();
    }
    return {};
}

void LoginLimit::succeed(const std::string& key) {
    const std::scoped_lock lock(mutex_);
    tries_.erase(key);
}

void LoginLimit::forget_oldest() {
    const auto oldest = std::min_element(
        tries_.begin(), tries_.end(),
        [](const auto& a, const auto& b) { return a.second.last < b.second.last; });
    tries_.erase(oldest);
}

}  // namespace leafcutter::server
