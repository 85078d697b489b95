// Verbs for what a workshop keeps in the daemon.

#pragma once

#include <string>

#include "server/cli/command.h"

namespace leafcutter::server {

// list, export and import of the collection /api/v1/<shelf>.
void add_shelf_verbs(CLI::App& command, const std::string& shelf, const CommonOptions& common);

}  // namespace leafcutter::server
