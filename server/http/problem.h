// Errors as clients see them: RFC 9457 problem details. The one place that knows which exception is
// which status.

#pragma once

#include <exception>
#include <map>
#include <stdexcept>
#include <string>

#include "server/http/response.h"

namespace leafcutter::server {

// Thrown by handlers; `what()` is the detail. That of a refused field (422) begins with the field's
// path, "grid.strip_width_mm: must be > 0", which clients get as a JSON pointer too.
class HttpProblem : public std::runtime_error {
public:
    HttpProblem(int http_status, std::string stable_code, const std::string& detail)
        : std::runtime_error(detail), status(http_status), code(std::move(stable_code)) {}

    int status;
    std::string code;  // For programs.
    std::map<std::string, std::string> headers;
};

Response problem_response(const HttpProblem& problem);

// Any exception that left a handler.
Response response_to(const std::exception& error);

}  // namespace leafcutter::server
