// Ctrl-C and a polite kill, as a stop request that long commands look at.

#pragma once

#include <csignal>
#include <stop_token>
#include <thread>

namespace leafcutter::server {

// While it lives, the first SIGINT or SIGTERM requests a stop; a second one ends the process as
// usual. One at a time.
class InterruptWatch {
public:
    InterruptWatch();
    ~InterruptWatch();
    InterruptWatch(const InterruptWatch&) = delete;
    InterruptWatch& operator=(const InterruptWatch&) = delete;

    std::stop_token token() const { return source_.get_token(); }

private:
    std::stop_source source_;
    struct sigaction before_int_ {};
    struct sigaction before_term_ {};
    int listen_ = -1;  // Reading end of the same pipe, open until the thread has ended.
    int wake_ = -1;    // Writing end of the pipe that the handler writes to.
    std::jthread thread_;
};

}  // namespace leafcutter::server
