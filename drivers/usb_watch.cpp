#include "drivers/usb_watch.h"

#include <sys/time.h>
#include <thread>
#include <utility>

#include "drivers/transport.h"
#include "drivers/usb_context.h"

namespace leafcutter::drivers {

namespace {

constexpr timeval kTurn{1, 0};  // Cut short by an event and by the watch's end.

class LibusbWatch final : public UsbWatch {
public:
    LibusbWatch(UsbContext context, std::function<void()> arrived)
        : context_(std::move(context)), arrived_(std::move(arrived)) {}
    LibusbWatch(const LibusbWatch&) = delete;
    LibusbWatch& operator=(const LibusbWatch&) = delete;
    ~LibusbWatch() override {
        if (thread_.joinable()) {
            thread_.request_stop();
            libusb_hotplug_deregister_callback(context_.get(), callback_);
            libusb_interrupt_event_handler(context_.get());
            thread_.join();
        }
    }

    bool begin(std::uint16_t vendor, std::uint16_t product) {
        const int result = libusb_hotplug_register_callback(
            context_.get(), LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED, LIBUSB_HOTPLUG_NO_FLAGS, vendor,
            product, LIBUSB_HOTPLUG_MATCH_ANY, &on_arrival, this, &callback_);
        if (result != LIBUSB_SUCCESS) {
            return false;
        }
        thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
        return true;
    }

private:
    static int LIBUSB_CALL on_arrival(libusb_context* /*context*/,
                                      libusb_device* /*device*/,
                                      libusb_hotplug_event /*event*/,
                                      void* watch) {
        static_cast<LibusbWatch*>(watch)->came_ = 1;
        return 0;
    }

    // The callback only takes note: no libusb function may be called from there, and `arrived` may.
    void run(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            timeval wait = kTurn;
            const int result =
                libusb_handle_events_timeout_completed(context_.get(), &wait, &came_);
            if (result != LIBUSB_SUCCESS && result != LIBUSB_ERROR_INTERRUPTED) {
                return;
            }
            if (std::exchange(came_, 0) != 0) {
                arrived_();
            }
        }
    }

    UsbContext context_;
    std::function<void()> arrived_;
    int came_ = 0;  // Of the thread.
    libusb_hotplug_callback_handle callback_ = 0;
    std::jthread thread_;  // Last: it ends before what it uses.
};

}  // namespace

std::unique_ptr<UsbWatch> watch_usb(std::uint16_t vendor,
                                    std::uint16_t product,
                                    std::function<void()> arrived) {
    if (libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) == 0) {
        return nullptr;
    }
    try {
        auto watch = std::make_unique<LibusbWatch>(open_usb_context(), std::move(arrived));
        if (watch->begin(vendor, product)) {
            return watch;
        }
    } catch (const LinkLost&) {
        return nullptr;  // No USB at all.
    }
    return nullptr;
}

}  // namespace leafcutter::drivers
