// Job parameters under a name, that everybody has from the start.

#pragma once

#include <string>
#include <vector>

#include "server/store/named_records.h"

namespace leafcutter::server {

// Each with name, description and params.
const std::vector<NamedRecord>& built_in_presets();

// Null if there is none of that id.
const NamedRecord* find_preset(const std::vector<NamedRecord>& presets, const std::string& id);

}  // namespace leafcutter::server
