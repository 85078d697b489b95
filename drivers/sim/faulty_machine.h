// A simulated machine with faults in it, for trying what a sender does about them.

#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/sim/grbl_machine.h"
#include "drivers/sim/sim_machine.h"

namespace leafcutter::drivers {

struct Fault {
    enum class Kind {
        DropByte,     // A byte of line `at` never arrives.
        DoubleByte,   // It arrives twice.
        CorruptByte,  // It arrives with a flipped bit.
        DropOk,       // The answer to line `at` never comes.
        DoubleOk,     // It comes twice.
        CorruptOk,    // It comes with a flipped bit.
        Delay,        // Nothing is heard of the controller for five seconds after it.
        Stall,        // The controller falls silent after it.
        Alarm,        // A hard limit trips after it.
        Reset,        // The controller loses power for a moment after it.
        PowerCut,     // It loses power and stays dark.
        Unplug        // The link is gone after it.
    };
    Kind kind = Kind::DropOk;
    std::size_t at = 1;  // Counts G-code lines from 1, since power-up.
};

// Reads "drop-byte:12", "double-byte:N", "corrupt-byte:N", "drop-ok:N", "double-ok:N",
// "corrupt-ok:N", "delay:N", "stall:N", "alarm:N", "reset:N", "power:N", "unplug:N".
// Throws std::invalid_argument.
Fault parse_fault(std::string_view text);

// A script: one fault a line, or several with commas between; `#` begins a comment. Throws
// std::invalid_argument.
std::vector<Fault> parse_faults(std::string_view text);

class FaultyMachine final : public SimMachine {
public:
    explicit FaultyMachine(const GrblMachineOptions& options, std::vector<Fault> faults = {});

    std::string feed(std::string_view bytes) override;
    std::string advance(double seconds) override;
    bool at_rest() const override { return machine_.at_rest(); }
    bool unplugged() const override { return unplugged_; }
    void power_cycle() override { machine_.power_cycle(); }
    double now_s() const override { return machine_.now_s(); }
    double beam_power() const override { return machine_.beam_power(); }
    const BeamLog& beam_log() const override { return machine_.beam_log(); }
    BeamLog& beam_log() override { return machine_.beam_log(); }

    // It never will again, once it has stalled, lost its power or its link.
    bool hears() const { return !silent_; }

    GrblMachine& machine() { return machine_; }
    const GrblMachine& machine() const { return machine_; }

private:
    std::string deliver(char byte);
    std::string disturb(std::string answer, std::size_t lines_before);
    void disturb_by(Fault fault, std::string& answer, std::size_t lines_before);

    GrblMachine machine_;
    std::vector<Fault> faults_;  // Yet to come, the last line's first.
    std::string line_;           // Received so far of the line that is coming in.
    std::size_t lines_begun_ = 0;
    double mute_until_s_ = 0.0;
    std::string held_back_;  // Said while mute.
    bool silent_ = false;    // Hears nothing and says nothing, for good.
    bool unplugged_ = false;
};

}  // namespace leafcutter::drivers
