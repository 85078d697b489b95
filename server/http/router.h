// Which handler answers which call. The table is the API; openapi.json tells the same to clients,
// and a test walks one against the other.

#pragma once

#include <span>
#include <string_view>

#include "server/auth/role.h"
#include "server/http/request.h"
#include "server/http/response.h"

namespace leafcutter::server {

class App;

using Handler = Response (*)(App& app, Request& request);

// Whether a call can turn the beam on: then a key must have been given that right by name.
enum class Beam { Off, MayFire };

struct Route {
    std::string_view method;
    std::string_view pattern;  // "{name}" is one segment, "{name...}" all the rest.
    Handler handler;
    Role least;  // Who may call it; handlers ask for more where it depends on the body.
    Beam beam = Beam::Off;
};

std::span<const Route> routes();

// Finds out who calls, finds the route, fills `request.captures`, calls. Throws HttpProblem (401,
// 403, 404, 405) and what handlers throw.
Response route(App& app, Request& request);

// The same with every exception translated, and what was done written into the audit log.
Response answer(App& app, Request& request);

// Whether `path` has the form of `pattern`; fills `captures`.
bool matches(std::string_view pattern, std::string_view path, Request& request);

}  // namespace leafcutter::server
