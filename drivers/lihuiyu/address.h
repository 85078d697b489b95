// Device URIs of Lihuiyu boards.
//
//   lihuiyu:usb                      the first board (USB 1a86:5512)
//   lihuiyu:usb?bus=1&address=4      that one, until it is plugged in again
//   lihuiyu:usb?port=1-2.3           the one in that socket
//   lihuiyu:tcp://host:port          the wire bytes of packet.h over TCP
//   lihuiyu:/dev/PORT                or over a pty
//   sim:lihuiyu                      a simulated machine of one's own
//
// After ? or & stand settings of the machine: board=M2 (A, B, B1, B2, M, M1, M2, M3), width and
// height of the bed in mm, x and down: where a program's origin lies, mm right of and below the
// home corner (by default the bed's lower left corner), dpi (steps per inch), slope (of speeds;
// 0.92 where a measured speed is 8 % too low).

#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "drivers/device.h"
#include "drivers/lihuiyu/encoder.h"
#include "drivers/usb_pipe.h"

namespace leafcutter::drivers {

inline constexpr std::uint16_t kLihuiyuVendor = 0x1A86;
inline constexpr std::uint16_t kLihuiyuProduct = 0x5512;

struct LihuiyuAddress {
    std::string link;  // What open_transport() takes; empty: USB.
    UsbPlace usb;
    EncoderOptions encoder;
};

// `address` is the URI without "lihuiyu:". Throws std::invalid_argument.
LihuiyuAddress parse_lihuiyu_address(std::string_view address);

// One setting of the machine; false if `key` is none. Throws std::invalid_argument.
bool set_lihuiyu_option(std::string_view key, std::string_view value, EncoderOptions& options);

// Opens the device of such a URI. Throws LinkLost, std::invalid_argument.
std::unique_ptr<Device> open_lihuiyu(std::string_view uri);

}  // namespace leafcutter::drivers
