#include "emulated_board.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <sys/ioctl.h>

#include <fmt/format.h>

namespace leafcutter::drivers {

namespace {

constexpr unsigned char kBulkOut = 0x02;
constexpr unsigned char kBulkIn = 0x82;
constexpr std::size_t kSetupBytes = 8;
constexpr std::string_view kBoardPath = "/sys/devices/usb1/1-2";

// Device, configuration, one vendor interface, bulk in and out of 32 bytes and an interrupt pipe.
constexpr std::string_view kBoard =
    "12011001ff000008861a125563020002000109022700010100c031"
    "09040000030001020007058202200000070502022000000705810308"
    "0001";
constexpr std::string_view kHub =
    "12010002090001406b1d0200060203020101"
    "0902190001010"
    "0e0000904000001090000000705810304000c";

void add(UMockdevTestbed* testbed,
         std::string_view path,
         unsigned address,
         std::string_view descriptors) {
    const std::string text = fmt::format(
        "P: /devices/{0}\nN: bus/usb/001/{1:03}\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\n"
        "E: BUSNUM=001\nE: DEVNUM={1:03}\nE: DEVNAME=/dev/bus/usb/001/{1:03}\n"
        "A: busnum=1\\n\nA: devnum={1}\\n\nA: bConfigurationValue=1\\n\nA: speed=12\\n\n"
        "A: idVendor={2}\\n\nA: idProduct={3}\\n\nH: descriptors={4}\n",
        path, address, path == "usb1" ? "1d6b" : "1a86", path == "usb1" ? "0002" : "5512",
        descriptors);
    GError* error = nullptr;
    if (umockdev_testbed_add_from_string(testbed, text.c_str(), &error) == FALSE) {
        throw std::runtime_error(fmt::format("umockdev: {}", error->message));
    }
}

usbdevfs_urb& urb_in(const UMockdevIoctlData* data) {
    return *reinterpret_cast<usbdevfs_urb*>(data->data);
}

}  // namespace

EmulatedBoard::EmulatedBoard()
    : testbed_(umockdev_testbed_new()), handler_(umockdev_ioctl_base_new()) {
    g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(on_ioctl), this);
    add(testbed_, "usb1", 1, kHub);
}

EmulatedBoard::~EmulatedBoard() {
    for (const auto* list : {&waiting_, &done_}) {
        for (const Urb& urb : *list) {
            g_object_unref(urb.data);
        }
    }
    g_object_unref(handler_);
    g_object_unref(testbed_);
}

void EmulatedBoard::plug(unsigned address) {
    {
        const std::lock_guard lock(mutex_);
        gone_ = false;
    }
    node_ = fmt::format("/dev/bus/usb/001/{:03}", address);
    umockdev_testbed_attach_ioctl(testbed_, node_.c_str(), handler_, nullptr);
    add(testbed_, "usb1/1-2", address, kBoard);  // Sends the event too.
}

void EmulatedBoard::unplug() {
    {
        const std::lock_guard lock(mutex_);
        gone_ = true;
        claimed_ = false;
        answers_.clear();
        while (!waiting_.empty()) {
            end(waiting_.front(), -ENODEV);
            waiting_.pop_front();
        }
    }
    umockdev_testbed_uevent(testbed_, std::string(kBoardPath).c_str(), "remove");
    umockdev_testbed_remove_device(testbed_, std::string(kBoardPath).c_str());
    umockdev_testbed_detach_ioctl(testbed_, node_.c_str(), nullptr);
}

std::vector<BurntPiece> EmulatedBoard::burnt() {
    const std::lock_guard lock(mutex_);
    return machine_.beam_log().pieces();
}

std::vector<Violation> EmulatedBoard::violations() {
    const std::lock_guard lock(mutex_);
    return machine_.violations();
}

std::size_t EmulatedBoard::packets() {
    const std::lock_guard lock(mutex_);
    return machine_.packets();
}

// ---- usbfs ----

gboolean EmulatedBoard::on_ioctl(UMockdevIoctlBase* /*base*/,
                                 UMockdevIoctlClient* client,
                                 gpointer self) {
    return static_cast<EmulatedBoard*>(self)->handle(client) ? TRUE : FALSE;
}

bool EmulatedBoard::handle(UMockdevIoctlClient* client) {
    const std::lock_guard lock(mutex_);
    UMockdevIoctlData* const arg = umockdev_ioctl_client_get_arg(client);
    const unsigned long request = umockdev_ioctl_client_get_request(client);
    const bool reaps = request == USBDEVFS_REAPURBNDELAY || request == USBDEVFS_REAPURB;
    const int error = gone_ && !reaps ? ENODEV : perform(request, arg);
    umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
    return true;
}

// Returns the error that the system call fails with, or 0.
int EmulatedBoard::perform(unsigned long request, UMockdevIoctlData* arg) {
    switch (request) {
        case USBDEVFS_GET_CAPABILITIES:
            return tell_capabilities(arg);
        case USBDEVFS_DISCONNECT_CLAIM:
        case USBDEVFS_CLAIMINTERFACE:
            return claim();
        case USBDEVFS_RELEASEINTERFACE:
            claimed_ = false;
            return 0;
        case USBDEVFS_GETDRIVER:
            return tell_driver(arg);
        case USBDEVFS_IOCTL:  // Only ever to call the kernel's driver back.
            ++given_back;
            return 0;
        case USBDEVFS_CLEAR_HALT:
            ++halts_cleared;
            return 0;
        case USBDEVFS_SETCONFIGURATION:
        case USBDEVFS_RESET:
            return 0;
        case USBDEVFS_SUBMITURB:
            return submit(arg);
        case USBDEVFS_DISCARDURB:
            return discard(arg);
        case USBDEVFS_REAPURB:
        case USBDEVFS_REAPURBNDELAY:
            return reap(arg);
        default:
            return ENOTTY;
    }
}

int EmulatedBoard::tell_capabilities(UMockdevIoctlData* arg) {
    const std::uint32_t able = USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
    UMockdevIoctlData* const data = umockdev_ioctl_data_resolve(arg, 0, sizeof able, nullptr);
    std::memcpy(data->data, &able, sizeof able);
    g_object_unref(data);
    return 0;
}

int EmulatedBoard::claim() {
    if (busy) {
        return EBUSY;
    }
    if (!kernel_driver.empty()) {
        kernel_driver.clear();
        ++detached;
    }
    claimed_ = true;
    return 0;
}

int EmulatedBoard::tell_driver(UMockdevIoctlData* arg) {
    const std::string name = claimed_ ? "usbfs" : kernel_driver;
    if (name.empty()) {
        return ENODATA;
    }
    UMockdevIoctlData* const data =
        umockdev_ioctl_data_resolve(arg, 0, sizeof(usbdevfs_getdriver), nullptr);
    auto& answer = *reinterpret_cast<usbdevfs_getdriver*>(data->data);
    name.copy(static_cast<char*>(answer.driver), sizeof answer.driver - 1);
    g_object_unref(data);
    return 0;
}

int EmulatedBoard::submit(UMockdevIoctlData* arg) {
    if (submit_error != 0) {
        return submit_error;
    }
    Urb urb;
    urb.data = umockdev_ioctl_data_resolve(arg, 0, sizeof(usbdevfs_urb), nullptr);
    const usbdevfs_urb request = urb_in(urb.data);
    if (request.type != USBDEVFS_URB_TYPE_CONTROL && !claimed_) {
        g_object_unref(urb.data);
        return EINVAL;
    }
    if (request.buffer_length > 0) {
        g_object_unref(umockdev_ioctl_data_resolve(urb.data, offsetof(usbdevfs_urb, buffer),
                                                   static_cast<gsize>(request.buffer_length),
                                                   nullptr));
    }
    carry_out(urb, urb_in(urb.data));
    return 0;
}

void EmulatedBoard::carry_out(Urb& urb, const usbdevfs_urb& request) {
    const std::string_view bytes(static_cast<const char*>(request.buffer),
                                 static_cast<std::size_t>(request.buffer_length));
    if (request.type == USBDEVFS_URB_TYPE_CONTROL && bytes.size() >= kSetupBytes) {
        const auto value = static_cast<unsigned char>(bytes[2]) |
                           static_cast<unsigned>(static_cast<unsigned char>(bytes[3])) << 8U;
        controls.push_back(static_cast<unsigned char>(bytes[1]));
        controls.push_back(static_cast<std::uint16_t>(value));
        end(urb, 0);
    } else if (request.endpoint == kBulkOut && stalls_once) {
        stalls_once = false;
        end(urb, -EPIPE);
    } else if (request.endpoint == kBulkOut && takes_bytes) {
        answers_ += machine_.feed(bytes);
        machine_.hurry();
        end(urb, 0);
    } else {
        waiting_.push_back(urb);
    }
    const auto reads = [](const Urb& one) { return urb_in(one.data).endpoint == kBulkIn; };
    const auto reader = std::find_if(waiting_.begin(), waiting_.end(), reads);
    if (!answers_.empty() && reader != waiting_.end()) {
        Urb waiter = *reader;
        waiting_.erase(reader);
        const auto most = static_cast<std::size_t>(urb_in(waiter.data).buffer_length);
        waiter.answer = answers_.substr(0, most);
        answers_.erase(0, waiter.answer.size());
        end(waiter, 0);
    }
}

void EmulatedBoard::end(Urb urb, int status) {
    urb.status = status;
    done_.push_back(urb);
}

int EmulatedBoard::reap(UMockdevIoctlData* arg) {
    if (done_.empty()) {
        return gone_ ? ENODEV : EAGAIN;
    }
    const Urb urb = done_.front();
    done_.pop_front();
    usbdevfs_urb& answer = urb_in(urb.data);
    answer.status = urb.status;
    const bool in = answer.endpoint == kBulkIn;
    const bool whole = urb.status == 0 && answer.type != USBDEVFS_URB_TYPE_CONTROL;
    answer.actual_length = whole ? answer.buffer_length : 0;
    if (in) {
        answer.actual_length = static_cast<int>(urb.answer.size());
        urb.answer.copy(static_cast<char*>(answer.buffer), urb.answer.size());
    }
    UMockdevIoctlData* const pointer = umockdev_ioctl_data_resolve(arg, 0, sizeof(void*), nullptr);
    umockdev_ioctl_data_set_ptr(pointer, 0, urb.data);
    g_object_unref(pointer);
    g_object_unref(urb.data);
    return 0;
}

int EmulatedBoard::discard(UMockdevIoctlData* arg) {
    gulong address = 0;
    std::memcpy(&address, arg->data, sizeof address);
    const auto found = std::find_if(waiting_.begin(), waiting_.end(), [address](const Urb& urb) {
        return urb.data->client_addr == address;
    });
    if (found == waiting_.end()) {
        return EINVAL;
    }
    const Urb urb = *found;
    waiting_.erase(found);
    end(urb, -ENOENT);
    return 0;
}

}  // namespace leafcutter::drivers
