// The dashboard's files, out of the binary.

#pragma once

#include <optional>

#include "server/http/request.h"
#include "server/http/response.h"

namespace leafcutter::server {

// Nothing if the dashboard has no such file. "/" is its page.
std::optional<Response> dashboard_file(const Request& request);

}  // namespace leafcutter::server
