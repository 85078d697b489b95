// Calls that only the node of a machine can answer, passed on to it.

#pragma once

#include <optional>
#include <string_view>

#include "server/http/request.h"
#include "server/http/response.h"

namespace leafcutter::server {

class App;

// Nothing if this node is to answer. Throws HttpProblem (503) if another one has to and is silent.
std::optional<Response> answer_elsewhere(App& app, Request& request, std::string_view pattern);

}  // namespace leafcutter::server
