// What of this host could be a machine: serial ports, and engravers on USB.

#pragma once

#include <optional>
#include <string>
#include <vector>

namespace leafcutter::drivers {

struct FoundPort {
    std::string uri;          // What `--device` takes; empty where no driver of ours fits.
    std::string path;         // "/dev/ttyUSB0", or "usb:1-2" for a device without a serial port.
    std::string stable_path;  // "/dev/serial/by-id/…" if there is one, else empty.
    std::string usb_id;       // "1a86:7523", empty for a port that isn't on USB.
    std::string description;  // Maker and product as the device says.
    std::string serial_number;
    std::string trouble;  // Why it can't be used as it is, and what to do; else empty.
};

// Directories to look into; other ones for tests.
struct DiscoveryRoots {
    std::string sys = "/sys";
    std::string dev = "/dev";
    std::string proc = "/proc";
};

// The programs that hold `path` open, as "cncjs (process 4711)", as far as this user may see them.
std::vector<std::string> holders_of(const std::string& path, const std::string& proc = "/proc");

std::vector<FoundPort> find_ports(const DiscoveryRoots& roots = {});

// Why opening `path` failed with this errno, and what to do about it.
std::string diagnose_open_failure(const std::string& path, int error_number);

}  // namespace leafcutter::drivers
