// A simulated machine as its host sees it: bytes in, bytes out, time only as it is told.

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "drivers/sim/beam_log.h"

namespace leafcutter::drivers {

// What a careful sender would never have made the machine do.
struct Violation {
    double t_s = 0.0;
    std::string text;
};

class SimMachine {
public:
    virtual ~SimMachine() = default;

    // Takes any split of the sender's bytes. Returns what the machine says until now.
    virtual std::string feed(std::string_view bytes) = 0;
    virtual std::string advance(double seconds) = 0;

    // Some time, for a sender that isn't to wait. None where nothing is left to do.
    virtual std::string hurry() { return at_rest() ? std::string() : advance(0.02); }

    // Hurries only when the sender has spoken, or not for some time: a machine that must be asked
    // is to be seen at all its states, however slow the sender is.
    virtual bool waits_for_questions() const { return false; }

    // Nothing moves, waits or is left to do.
    virtual bool at_rest() const = 0;

    // As if the supply had failed for a moment.
    virtual void power_cycle() = 0;

    virtual bool unplugged() const { return false; }
    virtual double now_s() const = 0;
    virtual double beam_power() const = 0;  // Put out at this moment; 0: off.
    virtual const BeamLog& beam_log() const = 0;
    virtual BeamLog& beam_log() = 0;

    // Since the last call.
    virtual std::vector<Violation> take_violations() { return {}; }
};

}  // namespace leafcutter::drivers
