#include "drivers/usb_pipe.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <libusb.h>

#include "drivers/transport.h"

namespace leafcutter::drivers {

namespace {

using std::chrono::milliseconds;

constexpr int kInterface = 0;
constexpr int kConfiguration = 1;
constexpr unsigned kControlTimeoutMs = 1500;

struct ContextCloser {
    void operator()(libusb_context* context) const { libusb_exit(context); }
};
using Context = std::unique_ptr<libusb_context, ContextCloser>;

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

std::string name_of(libusb_device* device) {
    return fmt::format("usb bus {} address {}", libusb_get_bus_number(device),
                       libusb_get_device_address(device));
}

// 0 would mean to wait for ever.
unsigned timeout_of(milliseconds timeout) {
    return static_cast<unsigned>(std::max<milliseconds::rep>(timeout.count(), 1));
}

class LibusbPipe final : public UsbPipe {
public:
    LibusbPipe(Context context, Handle handle, const UsbPlace& place)
        : context_(std::move(context)),
          handle_(std::move(handle)),
          place_(place),
          name_(name_of(libusb_get_device(handle_.get()))) {
        claim();
    }
    LibusbPipe(const LibusbPipe&) = delete;
    LibusbPipe& operator=(const LibusbPipe&) = delete;
    ~LibusbPipe() override { libusb_release_interface(handle_.get(), kInterface); }

    void control_out(std::uint8_t request, std::uint16_t value) override {
        const auto type =
            static_cast<std::uint8_t>(static_cast<unsigned>(LIBUSB_ENDPOINT_OUT) |
                                      static_cast<unsigned>(LIBUSB_REQUEST_TYPE_VENDOR) |
                                      static_cast<unsigned>(LIBUSB_RECIPIENT_DEVICE));
        const int result = libusb_control_transfer(handle_.get(), type, request, value, 0, nullptr,
                                                   0, kControlTimeoutMs);
        if (result < 0) {
            lost(name_, libusb_error_name(result));
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

    std::string description() const override { return name_; }

private:
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
            lost(name_, libusb_error_name(result));
        }
    }

    // Returns the bytes transferred.
    std::size_t transfer(std::uint8_t endpoint, std::string& bytes, milliseconds timeout) {
        int done = 0;
        const int result = libusb_bulk_transfer(
            handle_.get(), endpoint, reinterpret_cast<unsigned char*>(bytes.data()),
            static_cast<int>(bytes.size()), &done, timeout_of(timeout));
        if (result == LIBUSB_ERROR_NO_DEVICE) {
            lost(name_, "unplugged");
        }
        if (result == LIBUSB_ERROR_PIPE) {
            libusb_clear_halt(handle_.get(), endpoint);
        } else if (result != LIBUSB_SUCCESS && result != LIBUSB_ERROR_TIMEOUT &&
                   result != LIBUSB_ERROR_INTERRUPTED) {
            lost(name_, libusb_error_name(result));
        }
        return static_cast<std::size_t>(std::max(done, 0));
    }

    Context context_;
    Handle handle_;
    UsbPlace place_;
    std::string name_;
};

bool fits(libusb_device* device, const UsbPlace& place) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device, &descriptor) != LIBUSB_SUCCESS) {
        return false;
    }
    return descriptor.idVendor == place.vendor && descriptor.idProduct == place.product &&
           (!place.bus || *place.bus == libusb_get_bus_number(device)) &&
           (!place.address || *place.address == libusb_get_device_address(device));
}

std::string wanted(const UsbPlace& place) {
    std::string text = fmt::format("usb {:04x}:{:04x}", place.vendor, place.product);
    if (place.bus) {
        text += fmt::format(" bus {}", *place.bus);
    }
    if (place.address) {
        text += fmt::format(" address {}", *place.address);
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
        lost(name_of(device), libusb_error_name(result));
    }
    return Handle(handle);
}

}  // namespace

std::unique_ptr<UsbPipe> open_usb_pipe(const UsbPlace& place) {
    libusb_context* raw_context = nullptr;
    if (const int result = libusb_init(&raw_context); result != LIBUSB_SUCCESS) {
        lost(wanted(place), fmt::format("there is no USB here: {}", libusb_error_name(result)));
    }
    Context context(raw_context);
    libusb_device** raw_list = nullptr;
    const auto count = libusb_get_device_list(context.get(), &raw_list);
    if (count < 0) {
        lost(wanted(place), libusb_error_name(static_cast<int>(count)));
    }
    const DeviceList list(raw_list);
    for (libusb_device** device = raw_list; *device != nullptr; ++device) {
        if (fits(*device, place)) {
            Handle handle = open_device_of(*device, place);
            return std::make_unique<LibusbPipe>(std::move(context), std::move(handle), place);
        }
    }
    lost(wanted(place),
         "there is no such device; plug the machine in and see `leafcutter devices`");
}

}  // namespace leafcutter::drivers
