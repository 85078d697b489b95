// The wire of a simulated machine, seen from the machine: a pty or a TCP port.

#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>

namespace leafcutter::drivers {

class SimLink {
public:
    virtual ~SimLink() = default;

    // Waits up to `timeout` for bytes; empty after the time, or when nobody is connected.
    virtual std::string receive(std::chrono::milliseconds timeout) = 0;

    // What nobody takes is lost, as on a wire.
    virtual void send(std::string_view bytes) = 0;

    // Pulls the plug: whoever is connected finds the link gone.
    virtual void unplug() = 0;

    // What open_transport() takes.
    virtual std::string address() const = 0;
};

// With a path: a symbolic link to the port, removed at the end. Throws LinkLost.
std::unique_ptr<SimLink> open_pty_link(const std::string& symlink_path = {});

// Listens on the loopback alone; port 0 picks a free one. One client at a time. Throws LinkLost.
std::unique_ptr<SimLink> open_tcp_link(unsigned short port);

}  // namespace leafcutter::drivers
