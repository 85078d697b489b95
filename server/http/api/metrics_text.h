// Everything the daemon counts, in Prometheus' text format.

#pragma once

#include <string>

namespace leafcutter::server {

class App;

std::string metrics_text(App& app);

}  // namespace leafcutter::server
