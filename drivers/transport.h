// A byte stream to a machine: serial port, TCP, or a pipe to a simulated one.

#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace leafcutter::drivers {

// The link is gone or was never there; the message names the port and the reason.
class LinkLost : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

class Transport {
public:
    virtual ~Transport() = default;

    // Waits up to `timeout` for bytes and returns those there are; empty after the time.
    // Throws LinkLost as soon as the other end is gone.
    virtual std::string read_some(std::chrono::milliseconds timeout) = 0;

    // Writes all bytes. Throws LinkLost.
    virtual void write_all(std::string_view bytes) = 0;

    virtual std::string description() const = 0;
};

// Opens "…/dev/ttyUSB0?baud=115200" or "tcp://host:port" (the part of a device URI after the kind).
// Serial ports are locked exclusively. Throws LinkLost.
std::unique_ptr<Transport> open_transport(std::string_view address);

}  // namespace leafcutter::drivers
