// A simulated Lihuiyu machine of one's own, seen as a USB device.

#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "drivers/lihuiyu/encoder.h"
#include "drivers/sim/lihuiyu_machine.h"
#include "drivers/sim/sim_host.h"
#include "drivers/usb_pipe.h"

namespace leafcutter::drivers {

struct SimLihuiyuOptions {
    EncoderOptions encoder;  // Of its sender; board and bed are those of the machine.
    LihuiyuMachineOptions machine;
    SimHostOptions host;
};

// "burn=FILE&speed=N&fault=SPEC" and the settings of lihuiyu/address.h, all optional. Throws
// std::invalid_argument.
SimLihuiyuOptions parse_simulated_lihuiyu(std::string_view query);

// The machine moves on by the time between two calls. What it complains about ends the link: throws
// LinkLost with the first violation. Throws std::invalid_argument for a log that can't be written.
std::unique_ptr<UsbPipe> open_simulated_lihuiyu(const SimLihuiyuOptions& options);

}  // namespace leafcutter::drivers
