// Materials for a command: the built-in ones and those of a file.

#pragma once

#include <string>
#include <vector>

#include "fab/material/material.h"

namespace leafcutter::server {

// `file` may be empty. Throws UsageError if it can't be read, geometry::Error for what is wrong in
// it.
std::vector<fab::Material> wanted_materials(const std::string& file);

// Only those of the file.
std::vector<fab::Material> materials_of_file(const std::string& file);

}  // namespace leafcutter::server
