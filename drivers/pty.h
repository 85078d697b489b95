// A pseudo terminal: our end plays a controller, the other end looks like a serial port.

#pragma once

#include <optional>
#include <string>

#include "drivers/file_descriptor.h"

namespace leafcutter::drivers {

struct Pty {
    FileDescriptor controller;  // Our end, non-blocking.
    FileDescriptor keeper;      // Holds the port's side open, so that clients may come and go.
    std::string port_path;      // "/dev/pts/7"
};

// The port's side is raw and doesn't echo. Throws LinkLost.
Pty open_pty();

}  // namespace leafcutter::drivers
