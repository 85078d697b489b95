// Jobs and cuts of the daemon, followed live on the terminal until they are over.

#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "server/cli/api_client.h"
#include "server/cli/command.h"

namespace leafcutter::server {

// Returns it as it is at the end. Throws geometry::Cancelled on Ctrl-C: the job, the cut go on.
nlohmann::json follow_job(ApiClient& client, const std::string& id, const CommonOptions& common);
nlohmann::json follow_cut(ApiClient& client, const std::string& id, const CommonOptions& common);

// Until the cut's current sheet is over.
nlohmann::json follow_sheet(ApiClient& client, const std::string& id, const CommonOptions& common);

}  // namespace leafcutter::server
