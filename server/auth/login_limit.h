// Slows down whoever guesses passwords: a few tries are free, then each one costs twice the wait of
// the one before. Safe from any thread.

#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>

namespace leafcutter::server {

class LoginLimit {
public:
    using Clock = std::chrono::steady_clock;

    static constexpr int kFreeTries = 5;
    static constexpr std::chrono::seconds kFirstWait{12};
    static constexpr std::chrono::seconds kLongestWait{900};
    static constexpr std::size_t kMostKeys = 4096;  // The oldest are forgotten beyond it.

    // How long `key` (an address, or an address and a name) has to wait; zero: it may try. The try
    // counts as failed until succeed() is called.
    std::chrono::seconds try_now(const std::string& key, Clock::time_point now);
    void succeed(const std::string& key);

private:
    struct Tries {
        int count = 0;
        Clock::time_point last;
        Clock::time_point next;
    };

    void forget_oldest();

    std::mutex mutex_;  // Guards tries_.
    std::map<std::string, Tries> tries_;
};

}  // namespace leafcutter::server
