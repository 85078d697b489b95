// A USB device by its bulk pipes, through libusb.

#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace leafcutter::drivers {

class UsbPipe {
public:
    virtual ~UsbPipe() = default;

    // A vendor request to the device without data. Throws LinkLost.
    virtual void control_out(std::uint8_t request, std::uint16_t value) = 0;

    // Returns how many bytes the device has taken within `timeout`: fewer than all if it doesn't
    // take more. Throws LinkLost as soon as the device is gone.
    virtual std::size_t bulk_write(std::string_view bytes, std::chrono::milliseconds timeout) = 0;

    // Returns what came, at most `most` bytes; empty after `timeout`. Throws LinkLost.
    virtual std::string bulk_read(std::size_t most, std::chrono::milliseconds timeout) = 0;

    // Lets `time` pass. Throws LinkLost as soon as the device is gone.
    virtual void rest(std::chrono::milliseconds time) = 0;

    virtual std::string description() const = 0;
};

struct UsbPlace {
    std::uint16_t vendor = 0;
    std::uint16_t product = 0;
    std::optional<unsigned> bus;      // Without: the first device of that vendor and product.
    std::optional<unsigned> address;  // Another one each time that the device is plugged in.
    std::string port;                 // "1-2.3", bus and sockets: stays. Empty: any.
    std::uint8_t endpoint_out = 0x02;
    std::uint8_t endpoint_in = 0x82;
};

// Takes the device's first interface from a kernel driver that holds it, until the pipe is closed.
// Throws LinkLost, with the reason and what to do.
std::unique_ptr<UsbPipe> open_usb_pipe(const UsbPlace& place);

}  // namespace leafcutter::drivers
