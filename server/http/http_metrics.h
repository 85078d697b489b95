// What the daemon counts of its HTTP calls. Safe from any thread.

#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/latency_histogram.h"

namespace leafcutter::server {

class HttpMetrics {
public:
    // From a vetted head to the answer ready to be sent. Streams count until they begin.
    void add(std::string_view method, int status, std::chrono::steady_clock::duration time);

    // In Prometheus' text format.
    std::string text() const;

private:
    static constexpr std::array<std::string_view, 6> kMethods{"GET", "HEAD",   "POST",
                                                              "PUT", "DELETE", "OPTIONS"};

    struct OfMethod {
        LatencyHistogram latency;
        std::array<std::atomic<std::int64_t>, 5> by_class{};  // 1xx to 5xx.
    };

    std::array<OfMethod, kMethods.size()> methods_;
};

}  // namespace leafcutter::server
