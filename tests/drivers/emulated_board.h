// A Lihuiyu board on an emulated USB: umockdev stands in for the kernel's usbfs and udev, behind
// the real libusb. The test must run under umockdev-wrapper.

#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <linux/usbdevice_fs.h>
#include <mutex>
#include <string>
#include <string_view>
#include <umockdev.h>
#include <vector>

#include "drivers/sim/lihuiyu_machine.h"

namespace leafcutter::drivers {

class EmulatedBoard {
public:
    EmulatedBoard();
    EmulatedBoard(const EmulatedBoard&) = delete;
    EmulatedBoard& operator=(const EmulatedBoard&) = delete;
    ~EmulatedBoard();

    // Puts it into socket 1-2 of a hub at bus 1 with this address.
    void plug(unsigned address);
    void unplug();

    // What the kernel is to do, and has done. Set while nobody has the device open.
    bool busy = false;          // Another program has claimed it.
    bool takes_bytes = true;    // Bulk transfers to the device are taken.
    bool stalls_once = false;   // The next transfer to it ends with a stall.
    int submit_error = 0;       // What a transfer is refused with.
    std::string kernel_driver;  // Which holds the interface; empty: none.
    int detached = 0;           // How often a kernel driver had to let go.
    int given_back = 0;         // And was called back.
    int halts_cleared = 0;
    std::vector<std::uint16_t> controls;  // Request and value of each.

    std::vector<BurntPiece> burnt();
    std::vector<Violation> violations();
    std::size_t packets();

private:
    struct Urb {
        UMockdevIoctlData* data = nullptr;  // A reference of ours.
        int status = 0;
        std::string answer;
    };

    static gboolean on_ioctl(UMockdevIoctlBase* base, UMockdevIoctlClient* client, gpointer self);
    bool handle(UMockdevIoctlClient* client);
    int perform(unsigned long request, UMockdevIoctlData* arg);
    int tell_capabilities(UMockdevIoctlData* arg);
    int submit(UMockdevIoctlData* arg);
    int reap(UMockdevIoctlData* arg);
    int discard(UMockdevIoctlData* arg);
    int claim();
    int tell_driver(UMockdevIoctlData* arg);
    void carry_out(Urb& urb, const usbdevfs_urb& request);
    void end(Urb urb, int status);

    std::mutex mutex_;  // Guards all below: umockdev calls from a thread of its own.
    LihuiyuMachine machine_;
    std::string answers_;
    std::deque<Urb> waiting_;  // For bytes from the board, or for ever.
    std::deque<Urb> done_;
    bool claimed_ = false;
    bool gone_ = true;
    UMockdevTestbed* testbed_;
    UMockdevIoctlBase* handler_;
    std::string node_;
};

}  // namespace leafcutter::drivers
