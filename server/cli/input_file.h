// The bytes of a file named on the command line.

#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace leafcutter::server {

// Throws UsageError naming the file if it can't be read or is larger than `max_bytes`.
std::vector<std::byte> read_input_file(const std::string& path, std::size_t max_bytes);

}  // namespace leafcutter::server
