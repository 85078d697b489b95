// A simulated machine that speaks in lines, on a wire with one fault in it. Knows no protocol but
// the line end and "ok".

#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "drivers/sim/sim_machine.h"

namespace leafcutter::drivers {

struct WireFault {
    enum class Kind {
        FlipBit,   // In the middle of the `at`-th line to the machine.
        DropLine,  // That line is never heard.
        DropByte,  // Its last byte, the line end, is lost: it runs into the next one.
        DropOk,    // The `at`-th ok never comes.
        GarbleOk,  // It comes with a flipped bit.
        DoubleOk,  // It comes twice.
        Stall,     // Nothing more is heard of the machine.
        Reset,     // It loses power for a moment before that ok.
        Unplug     // The link is gone.
    };
    Kind kind = Kind::DropOk;
    std::size_t at = 1;  // Counts from 1, since the machine's power-up.
};

// Reads "flip-bit:12", "drop-line:N", "drop-byte:N", "drop-ok:N", "garble-ok:N", "double-ok:N",
// "stall:N", "reset:N", "unplug:N". Throws std::invalid_argument.
WireFault parse_wire_fault(std::string_view text);

class FaultyWire final : public SimMachine {
public:
    FaultyWire(std::unique_ptr<SimMachine> machine, const WireFault& fault)
        : machine_(std::move(machine)), fault_(fault) {}

    std::string feed(std::string_view bytes) override;
    std::string advance(double seconds) override;
    std::string hurry() override { return disturb_answers(machine_->hurry()); }
    bool at_rest() const override { return machine_->at_rest(); }
    bool unplugged() const override { return unplugged_; }
    double now_s() const override { return machine_->now_s(); }
    double beam_power() const override { return machine_->beam_power(); }
    const BeamLog& beam_log() const override { return std::as_const(*machine_).beam_log(); }
    BeamLog& beam_log() override { return machine_->beam_log(); }
    void power_cycle() override { machine_->power_cycle(); }

private:
    std::string disturb_line(std::string line);
    std::string disturb_answers(std::string_view bytes);
    std::string disturb_ok(std::string line);

    std::unique_ptr<SimMachine> machine_;
    WireFault fault_;
    std::string to_machine_;  // Of a line not yet whole.
    std::string to_host_;
    std::size_t lines_ = 0;
    std::size_t oks_ = 0;
    bool silent_ = false;
    bool unplugged_ = false;
};

}  // namespace leafcutter::drivers
