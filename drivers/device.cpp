#include "drivers/device.h"

#include "drivers/grbl/device.h"
#include "drivers/sim/sim_transport.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {

std::string_view to_string(MachineState state) {
    switch (state) {
        case MachineState::Disconnected:
            return "disconnected";
        case MachineState::Idle:
            return "idle";
        case MachineState::Run:
            return "run";
        case MachineState::Hold:
            return "hold";
        case MachineState::Jog:
            return "jog";
        case MachineState::Home:
            return "home";
        case MachineState::Alarm:
            return "alarm";
        case MachineState::Door:
            return "door";
        case MachineState::Check:
            return "check";
        case MachineState::Sleep:
            return "sleep";
        case MachineState::Unknown:
            return "unknown";
    }
    return "unknown";
}

std::unique_ptr<Device> open_device(std::string_view uri) {
    constexpr std::string_view kGrbl = "grbl:";
    constexpr std::string_view kSimulated = "sim:grbl";
    std::unique_ptr<Transport> transport;
    if (uri.substr(0, kGrbl.size()) == kGrbl) {
        transport = open_transport(uri.substr(kGrbl.size()));
    } else if (uri == kSimulated || uri.substr(0, kSimulated.size() + 1) == "sim:grbl?") {
        transport = open_simulated_grbl(uri.substr(std::min(kSimulated.size() + 1, uri.size())));
    } else {
        throw std::invalid_argument(
            "device \"" + std::string(uri) +
            "\": must be grbl:/dev/PORT?baud=N, grbl:tcp://host:port or sim:grbl");
    }
    auto device = std::make_unique<GrblDevice>(std::string(uri), std::move(transport));
    device->attach();
    return device;
}

}  // namespace leafcutter::drivers
