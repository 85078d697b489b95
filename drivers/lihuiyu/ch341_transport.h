// The wire bytes of packet.h over a CH341 chip in its EPP mode, as the boards have it.

#pragma once

#include <memory>

#include "drivers/transport.h"
#include "drivers/usb_pipe.h"

namespace leafcutter::drivers {

// Puts the chip into EPP mode 1.9. A transfer that the board doesn't take for 5 s, or takes in
// part, is the end of the link. Throws LinkLost.
std::unique_ptr<Transport> open_ch341(std::unique_ptr<UsbPipe> pipe);

}  // namespace leafcutter::drivers
