// The names and addresses under which this host is reached.

#pragma once

#include <string>
#include <vector>

namespace leafcutter::server {

// The host's own name; empty if it has none.
std::string lower_host_name();

// As Host headers say them (IPv6 in brackets): that address, or for a wildcard those of every
// interface; and the host's own name, plain and with .local, unless the address is loopback.
std::vector<std::string> own_host_names(const std::string& listen_address);

}  // namespace leafcutter::server
