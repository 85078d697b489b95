// A simulated machine with one fault in it, for trying what a sender does about it.

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/sim/grbl_machine.h"
#include "drivers/sim/sim_machine.h"

namespace leafcutter::drivers {

struct Fault {
    enum class Kind {
        DropOk,     // The answer to line `at` never comes.
        CorruptOk,  // It comes with a flipped bit.
        Stall,      // The controller falls silent after it.
        Alarm,      // A hard limit trips after it.
        Reset,      // The controller loses power for a moment after it.
        Unplug      // The link is gone after it.
    };
    Kind kind = Kind::DropOk;
    std::size_t at = 1;  // Counts G-code lines answered since power-up, from 1.
};

// Reads "drop-ok:12", "corrupt-ok:N", "stall:N", "alarm:N", "reset:N", "unplug:N".
// Throws std::invalid_argument.
Fault parse_fault(std::string_view text);

class FaultyMachine final : public SimMachine {
public:
    explicit FaultyMachine(const GrblMachineOptions& options, std::optional<Fault> fault = {});

    std::string feed(std::string_view bytes) override;
    std::string advance(double seconds) override;
    bool at_rest() const override { return machine_.at_rest(); }
    bool unplugged() const override { return unplugged_; }
    void power_cycle() override { machine_.power_cycle(); }
    double now_s() const override { return machine_.now_s(); }
    double beam_power() const override { return machine_.beam_power(); }
    const BeamLog& beam_log() const override { return machine_.beam_log(); }
    BeamLog& beam_log() override { return machine_.beam_log(); }

    GrblMachine& machine() { return machine_; }
    const GrblMachine& machine() const { return machine_; }

private:
    std::string disturb(std::string answer, std::size_t lines_before);

    GrblMachine machine_;
    std::optional<Fault> fault_;
    bool silent_ = false;
    bool unplugged_ = false;
};

}  // namespace leafcutter::drivers
