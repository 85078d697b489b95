#include "drivers/usb_pipe.h"

#include <algorithm>
#include <array>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "drivers/transport.h"
#include "drivers/usb_context.h"

namespace leafcutter::drivers {

namespace {

using std::chrono::milliseconds;

constexpr int kInterface = 0;
constexpr int kConfiguration = 1;
constexpr unsigned kControlTimeoutMs = 1500;

struct HandleCloser {
    void operator()(libusb_device_handle* handle) const { libusb_close(handle); }
};
using Handle = std::unique_ptr<libusb_device_handle, HandleCloser>;

struct ListCloser {
    void operator()(libusb_device** list) const { libusb_free_device_list(list, 1); }
};
using DeviceList = std::unique_ptr<libusb_device*, ListCloser>;

[[noreturn]] void lost(std::string_view device, std::string_view reason) {
    throw LinkLost(fmt::format("{}: {}", device, reason));
}

std::string text_of(int error) {
    return fmt::format("{} ({})", libusb_strerror(error), libusb_error_name(error));
}

std::string name_of(libusb_device* device) {
    return fmt::format("usb bus {} address {}", libusb_get_bus_number(device),
                       libusb_get_device_address(device));
}

// As the kernel names it: "1-2.3".
std::string port_of(libusb_device* device) {
    std::array<std::uint8_t, 7> numbers{};  // USB allows no more hubs in a row.
    const int count =
        libusb_get_port_numbers(device, numbers.data(), static_cast<int>(numbers.size()));
    return fmt::format("{}-{}", libusb_get_bus_number(device),
                       fmt::join(numbers.begin(), numbers.begin() + std::max(count, 0), "."));
}

// 0 would mean to wait for ever.
unsigned timeout_of(milliseconds timeout) {
    return static_cast<unsigned>(std::max<milliseconds::rep>(timeout.count(), 1));
}

class LibusbPipe final : public UsbPipe {
public:
    LibusbPipe(UsbContext context, Handle handle, const UsbPlace& place)
        : context_(std::move(context)),
          handle_(std::move(handle)),
          place_(place),
          name_(name_of(libusb_get_device(handle_.get()))) {
        claim();
        watch();
    }
    LibusbPipe(const LibusbPipe&) = delete;
    LibusbPipe& operator=(const LibusbPipe&) = delete;
    ~LibusbPipe() override {
        if (watches_) {
            libusb_hotplug_deregister_callback(context_.get(), callback_);
        }
        libusb_release_interface(handle_.get(), kInterface);
    }

    void control_out(std::uint8_t request, std::uint16_t value) override {
        const auto type =
            static_cast<std::uint8_t>(static_cast<unsigned>(LIBUSB_ENDPOINT_OUT) |
                                      static_cast<unsigned>(LIBUSB_REQUEST_TYPE_VENDOR) |
                                      static_cast<unsigned>(LIBUSB_RECIPIENT_DEVICE));
        const int result = libusb_control_transfer(handle_.get(), type, request, value, 0, nullptr,
                                                   0, kControlTimeoutMs);
        if (result < 0) {
            fail(result);
        }
    }

    std::size_t bulk_write(std::string_view bytes, milliseconds timeout) override {
        std::string copy(bytes);  // libusb takes no constant bytes.
        return transfer(place_.endpoint_out, copy, timeout);
    }

    std::string bulk_read(std::size_t most, milliseconds timeout) override {
        std::string bytes(most, '\0');
        bytes.resize(transfer(place_.endpoint_in, bytes, timeout));
        return bytes;
    }

    void rest(milliseconds time) override {
        if (!watches_) {
            std::this_thread::sleep_for(time);
            return;
        }
        handle_events_for(context_.get(), time, &gone_);
        if (gone_ != 0) {
            fail(LIBUSB_ERROR_NO_DEVICE);
        }
    }

    std::string description() const override { return name_; }

private:
    [[noreturn]] void fail(int error) const {
        const bool unplugged = gone_ != 0 || error == LIBUSB_ERROR_NO_DEVICE;
        lost(name_, unplugged ? "unplugged" : text_of(error));
    }

    static int LIBUSB_CALL on_left(libusb_context* /*context*/,
                                   libusb_device* device,
                                   libusb_hotplug_event /*event*/,
                                   void* pipe) {
        auto* const self = static_cast<LibusbPipe*>(pipe);
        if (device == libusb_get_device(self->handle_.get())) {
            self->gone_ = 1;
        }
        return 0;
    }

    void watch() {
        watches_ = libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) != 0 &&
                   libusb_hotplug_register_callback(
                       context_.get(), LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT, LIBUSB_HOTPLUG_NO_FLAGS,
                       place_.vendor, place_.product, LIBUSB_HOTPLUG_MATCH_ANY, &on_left, this,
                       &callback_) == LIBUSB_SUCCESS;
    }

    void claim() {
        // Some systems know no kernel drivers to detach: then there is none in the way.
        libusb_set_auto_detach_kernel_driver(handle_.get(), 1);
        int configuration = 0;
        if (libusb_get_configuration(handle_.get(), &configuration) == LIBUSB_SUCCESS &&
            configuration != kConfiguration) {
            libusb_set_configuration(handle_.get(), kConfiguration);
        }
        const int result = libusb_claim_interface(handle_.get(), kInterface);
        if (result == LIBUSB_ERROR_BUSY) {
            lost(name_, "another program has it open; close that one first");
        }
        if (result != LIBUSB_SUCCESS) {
            fail(result);
        }
    }

    // Returns the bytes transferred.
    std::size_t transfer(std::uint8_t endpoint, std::string& bytes, milliseconds timeout) {
        int done = 0;
        const int result = libusb_bulk_transfer(
            handle_.get(), endpoint, reinterpret_cast<unsigned char*>(bytes.data()),
            static_cast<int>(bytes.size()), &done, timeout_of(timeout));
        if (result == LIBUSB_ERROR_PIPE) {
            libusb_clear_halt(handle_.get(), endpoint);
        } else if (gone_ != 0 || (result != LIBUSB_SUCCESS && result != LIBUSB_ERROR_TIMEOUT &&
                                  result != LIBUSB_ERROR_INTERRUPTED)) {
            fail(result);
        }
        return static_cast<std::size_t>(std::max(done, 0));
    }

    UsbContext context_;
    Handle handle_;
    UsbPlace place_;
    std::string name_;
    bool watches_ = false;  // The system tells what is unplugged.
    int gone_ = 0;          // Set while events are handled, by this thread; an int for libusb.
    libusb_hotplug_callback_handle callback_ = 0;
};

bool is_kind(libusb_device* device, const UsbPlace& place) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device, &descriptor) != LIBUSB_SUCCESS) {
        return false;
    }
    return descriptor.idVendor == place.vendor && descriptor.idProduct == place.product;
}

bool stands_at(libusb_device* device, const UsbPlace& place) {
    return (!place.bus || *place.bus == libusb_get_bus_number(device)) &&
           (!place.address || *place.address == libusb_get_device_address(device)) &&
           (place.port.empty() || place.port == port_of(device));
}

std::string wanted(const UsbPlace& place) {
    std::string text = fmt::format("usb {:04x}:{:04x}", place.vendor, place.product);
    if (place.bus) {
        text += fmt::format(" bus {}", *place.bus);
    }
    if (place.address) {
        text += fmt::format(" address {}", *place.address);
    }
    if (!place.port.empty()) {
        text += fmt::format(" port {}", place.port);
    }
    return text;
}

Handle open_device_of(libusb_device* device, const UsbPlace& place) {
    libusb_device_handle* handle = nullptr;
    const int result = libusb_open(device, &handle);
    if (result == LIBUSB_ERROR_ACCESS) {
        lost(name_of(device),
             fmt::format("permission denied; allow it with a udev rule: SUBSYSTEM==\"usb\", "
                         "ATTR{{idVendor}}==\"{:04x}\", ATTR{{idProduct}}==\"{:04x}\", "
                         "TAG+=\"uaccess\"; then plug it in again",
                         place.vendor, place.product));
    }
    if (result != LIBUSB_SUCCESS) {
        lost(name_of(device), text_of(result));
    }
    return Handle(handle);
}

}  // namespace

std::unique_ptr<UsbPipe> open_usb_pipe(const UsbPlace& place) {
    UsbContext context = open_usb_context();
    libusb_device** raw_list = nullptr;
    const auto count = libusb_get_device_list(context.get(), &raw_list);
    if (count < 0) {
        lost(wanted(place), text_of(static_cast<int>(count)));
    }
    const DeviceList list(raw_list);
    std::string elsewhere;
    for (libusb_device** device = raw_list; *device != nullptr; ++device) {
        if (!is_kind(*device, place)) {
            continue;
        }
        if (stands_at(*device, place)) {
            Handle handle = open_device_of(*device, place);
            return std::make_unique<LibusbPipe>(std::move(context), std::move(handle), place);
        }
        elsewhere += fmt::format("{} port={}", elsewhere.empty() ? "" : ",", port_of(*device));
    }
    lost(wanted(place),
         elsewhere.empty()
             ? "there is no such device; plug the machine in and see `leafcutter devices`"
             : fmt::format("there is none at that place, but at{}: name it so", elsewhere));
}

}  // namespace leafcutter::drivers
