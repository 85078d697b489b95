// What most handlers begin and end with.

#pragma once

#include <nlohmann/json_fwd.hpp>

#include "server/http/request.h"
#include "server/http/response.h"
#include "server/store/records.h"

namespace leafcutter::server {

class App;

Response json_response(const nlohmann::json& value, int status = 200);

// Of the route's {id}. Throws HttpProblem (404).
JobRecord find_job(App& app, const Request& request);
CutRecord find_cut(App& app, const Request& request);

}  // namespace leafcutter::server
