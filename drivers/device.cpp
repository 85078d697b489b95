#include "drivers/device.h"

namespace leafcutter::drivers {

std::string_view to_string(MachineState state) {
    switch (state) {
        case MachineState::Disconnected: return "disconnected";
        case MachineState::Idle: return "idle";
        case MachineState::Run: return "run";
        case MachineState::Hold: return "hold";
        case MachineState::Jog: return "jog";
        case MachineState::Home: return "home";
        case MachineState::Alarm: return "alarm";
        case MachineState::Door: return "door";
        case MachineState::Check: return "check";
        case MachineState::Sleep: return "sleep";
        case MachineState::Unknown: return "unknown";
    }
    return "unknown";
}

}  // namespace leafcutter::drivers
