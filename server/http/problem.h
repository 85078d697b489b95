// Errors as clients see them: RFC 9457 problem details. The one place that knows which exception is
// which status.

#pragma once

#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/http/response.h"

namespace leafcutter::server {

struct FieldError {
    std::string pointer;  // JSON pointer into the body: "/grid/strip_width_mm".
    std::string detail;
};

// Thrown by handlers; `what()` is the detail.
class HttpProblem : public std::runtime_error {
public:
    HttpProblem(int http_status, std::string stable_code, const std::string& detail)
        : std::runtime_error(detail), status(http_status), code(std::move(stable_code)) {}

    int status;
    std::string code;  // For programs.
    std::vector<FieldError> errors;
};

Response problem_response(const HttpProblem& problem);

// Any exception that left a handler.
Response response_to(const std::exception& error);

}  // namespace leafcutter::server
