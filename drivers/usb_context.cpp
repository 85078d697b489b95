#include "drivers/usb_context.h"

#include <algorithm>
#include <sys/time.h>
#include <thread>

#include <fmt/format.h>

#include "drivers/transport.h"

namespace leafcutter::drivers {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;

UsbContext open_usb_context() {
    libusb_context* context = nullptr;
    if (const int result = libusb_init(&context); result != LIBUSB_SUCCESS) {
        throw LinkLost(fmt::format("usb: there is none here: {}", libusb_strerror(result)));
    }
    return UsbContext(context);
}

void handle_events_for(libusb_context* context, std::chrono::milliseconds time, int* done) {
    const Clock::time_point end = Clock::now() + time;
    while (*done == 0) {
        const auto left = std::chrono::duration_cast<microseconds>(end - Clock::now());
        if (left <= microseconds(0)) {
            return;
        }
        timeval wait{left.count() / 1000000, static_cast<suseconds_t>(left.count() % 1000000)};
        const int result = libusb_handle_events_timeout_completed(context, &wait, done);
        if (result != LIBUSB_SUCCESS && result != LIBUSB_ERROR_INTERRUPTED) {
            std::this_thread::sleep_until(end);
        }
    }
}

}  // namespace leafcutter::drivers
