// Job parameters from the command line: a file, then single assignments.

#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace leafcutter::server {

// Checked already. Throws UsageError for a file that can't be read, geometry::Error for parameters
// that can't be.
nlohmann::json wanted_params(const std::string& params_file,
                             const std::vector<std::string>& assignments);

}  // namespace leafcutter::server
