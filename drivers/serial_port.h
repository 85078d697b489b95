// A serial port: raw 8N1 at any baud rate, locked for one program.

#pragma once

#include <memory>
#include <string>

#include "drivers/transport.h"

namespace leafcutter::drivers {

// Closing doesn't drop DTR (no HUPCL), so that attaching again needn't reset the board.
// Throws LinkLost with what to do: permissions, another program, a port that isn't there.
std::unique_ptr<Transport> open_serial_port(const std::string& path, unsigned baud);

}  // namespace leafcutter::drivers
