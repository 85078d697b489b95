// A link to a simulated machine of one's own, which lives as long as the link.

#pragma once

#include <memory>
#include <string_view>

#include "drivers/transport.h"

namespace leafcutter::drivers {

// `query`: "burn=FILE&speed=N&width=MM&height=MM&fault=SPEC", all optional. The machine sits behind
// a real pty. Throws std::invalid_argument, LinkLost.
std::unique_ptr<Transport> open_simulated_grbl(std::string_view query);

// "burn=FILE&speed=N&fault=SPEC", the fault as of parse_wire_fault(). Throw the same.
std::unique_ptr<Transport> open_simulated_marlin(std::string_view query);
std::unique_ptr<Transport> open_simulated_smoothie(std::string_view query);

}  // namespace leafcutter::drivers
