// Which handler answers which call. The table is the API; openapi.json tells the same to clients,
// and a test walks one against the other.

#pragma once

#include <span>
#include <string_view>

#include "server/http/request.h"
#include "server/http/response.h"

namespace leafcutter::server {

class App;

using Handler = Response (*)(App& app, Request& request);

struct Route {
    std::string_view method;
    std::string_view pattern;  // "{name}" is one segment, "{name...}" all the rest.
    Handler handler;
};

std::span<const Route> routes();

// Finds the route, fills `request.captures`, calls. Throws HttpProblem (404, 405) and what handlers
// throw.
Response route(App& app, Request& request);

// Whether `path` has the form of `pattern`; fills `captures`.
bool matches(std::string_view pattern, std::string_view path, Request& request);

}  // namespace leafcutter::server
