#include "server/latency_histogram.h"

#include <algorithm>

#include <fmt/format.h>

namespace leafcutter::server {

void LatencyHistogram::add(std::chrono::steady_clock::duration time) {
    const double seconds = std::chrono::duration<double>(time).count();
    const auto* const bound = std::lower_bound(kBoundsS.begin(), kBoundsS.end(), seconds);
    ++counts_.at(static_cast<std::size_t>(bound - kBoundsS.begin()));
    sum_us_ += std::chrono::duration_cast<std::chrono::microseconds>(time).count();
}

std::string LatencyHistogram::text(std::string_view name, std::string_view labels) const {
    const std::string_view comma = labels.empty() ? "" : ",";
    const std::string alone = labels.empty() ? "" : fmt::format("{{{}}}", labels);
    std::string lines;
    std::int64_t total = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        total += counts_.at(i);
        const std::string bound =
            i < kBoundsS.size() ? fmt::format("{}", kBoundsS.at(i)) : std::string("+Inf");
        lines += fmt::format("{}_bucket{{{}{}le=\"{}\"}} {}\n", name, labels, comma, bound, total);
    }
    constexpr double kMicro = 1e-6;
    lines += fmt::format("{}_sum{} {:.6f}\n", name, alone, kMicro * static_cast<double>(sum_us_));
    lines += fmt::format("{}_count{} {}\n", name, alone, total);
    return lines;
}

}  // namespace leafcutter::server
