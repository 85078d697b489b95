// A controller behind TCP: an ESP bridge, a telnet port, a simulated machine.

#pragma once

#include <memory>
#include <string>

#include "drivers/transport.h"

namespace leafcutter::drivers {

// Waits up to 5 s for the connection. Throws LinkLost.
std::unique_ptr<Transport> open_tcp_socket(const std::string& host, const std::string& port);

}  // namespace leafcutter::drivers
