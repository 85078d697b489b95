#include "server/http/http_metrics.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

namespace leafcutter::server {

void HttpMetrics::add(std::string_view method,
                      int status,
                      std::chrono::steady_clock::duration time) {
    const auto* const found = std::find(kMethods.begin(), kMethods.end(), method);
    if (found == kMethods.end()) {
        return;
    }
    OfMethod& of_method = methods_.at(static_cast<std::size_t>(found - kMethods.begin()));
    of_method.latency.add(time);
    ++of_method.by_class.at(static_cast<std::size_t>(std::clamp(status / 100, 1, 5) - 1));
}

std::string HttpMetrics::text() const {
    std::string lines = "# TYPE leafcutter_http_requests_total counter\n";
    for (std::size_t i = 0; i < kMethods.size(); ++i) {
        for (std::size_t group = 0; group < methods_.at(i).by_class.size(); ++group) {
            lines +=
                fmt::format("leafcutter_http_requests_total{{method=\"{}\",class=\"{}xx\"}} {}\n",
                            kMethods.at(i), group + 1, methods_.at(i).by_class.at(group));
        }
    }
    lines += "# TYPE leafcutter_http_request_seconds histogram\n";
    for (std::size_t i = 0; i < kMethods.size(); ++i) {
        lines += methods_.at(i).latency.text("leafcutter_http_request_seconds",
                                             fmt::format("method=\"{}\"", kMethods.at(i)));
    }
    return lines;
}

}  // namespace leafcutter::server
