// libusb's context, for the files that speak to libusb.

#pragma once

#include <chrono>
#include <memory>

#include <libusb.h>

namespace leafcutter::drivers {

struct UsbContextCloser {
    void operator()(libusb_context* context) const { libusb_exit(context); }
};
using UsbContext = std::unique_ptr<libusb_context, UsbContextCloser>;

// Throws LinkLost where there is no USB.
UsbContext open_usb_context();

// Handles the events of `context` for `time`, or until *done is not 0.
void handle_events_for(libusb_context* context, std::chrono::milliseconds time, int* done);

}  // namespace leafcutter::drivers
