// How long something took, counted in buckets for Prometheus. Safe from any thread, without locks.

#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace leafcutter::server {

class LatencyHistogram {
public:
    void add(std::chrono::steady_clock::duration time);

    // The lines of `name`_bucket, _sum and _count, in seconds; `labels` is empty or "a=\"b\"".
    std::string text(std::string_view name, std::string_view labels) const;

private:
    static constexpr std::array<double, 12> kBoundsS{0.001, 0.0025, 0.005, 0.01, 0.025, 0.05,
                                                     0.1,   0.25,   0.5,   1.0,  2.5,   10.0};

    std::array<std::atomic<std::int64_t>, kBoundsS.size() + 1> counts_{};
    std::atomic<std::int64_t> sum_us_{0};
};

}  // namespace leafcutter::server
