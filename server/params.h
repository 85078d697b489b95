// Job parameters as JSON, in and out (docs: job parameters). The same for files, --set and the API.

#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "fab/job_params.h"

namespace leafcutter::server {

// Parses JSON text, called `what` in messages. Throws geometry::Error(BadOption) naming the place
// of a syntax error, a key that is there twice, or nesting deeper than parameters go.
nlohmann::json parse_params_text(std::string_view text, const std::string& what = "parameters");

// Sets one value in `params`: "grid.strip_width_mm=5". What is no JSON value is taken as text.
// Throws geometry::Error(BadOption) for an assignment without path or "=".
void set_param(nlohmann::json& params, std::string_view assignment);

// Typed parameters; what is absent keeps its default.
//
// Throws geometry::Error: BadOption for an unknown key, a wrong type or an impossible value;
// NotSupported for what is understood and not computed yet. Messages start with the full path.
fab::JobParams params_from_json(const nlohmann::json& params);

// All parameters, such that params_from_json gives them back.
nlohmann::json params_to_json(const fab::JobParams& params);

}  // namespace leafcutter::server
