// Notices USB devices that are plugged in, at once.

#pragma once

#include <cstdint>
#include <functional>
#include <memory>

namespace leafcutter::drivers {

class UsbWatch {
public:
    virtual ~UsbWatch() = default;
};

// Calls `arrived`, from a thread of its own, for each device of that vendor and product plugged in
// while the watch lives. Null where the system doesn't tell of such: look from time to time then.
std::unique_ptr<UsbWatch> watch_usb(std::uint16_t vendor,
                                    std::uint16_t product,
                                    std::function<void()> arrived);

}  // namespace leafcutter::drivers
