// Runs lines of G-code on a motion queue, one at a time: what the simulated Marlin and Smoothieware
// have in common. Power goes with moves alone: M3, M4 and M5 wait for nothing and light nothing
// that stands.

#pragma once

#include <deque>
#include <string>

#include "drivers/sim/beam_log.h"
#include "drivers/sim/gcode_interpreter.h"
#include "drivers/sim/motion_queue.h"

namespace leafcutter::drivers {

class GcodeRunner {
public:
    GcodeRunner() { interpreter_.reset({}); }

    // Takes a stripped line; the one before must be done. Returns Grbl's number of what is wrong
    // with it, 0: nothing.
    int begin(const std::string& stripped);

    // The line is done once every move before it has ended.
    void wait_for_stand() { waits_for_stand_ = true; }
    void home();  // Once every move before it has ended, which takes a while.

    // Goes on as far as it gets without time passing. Returns whether the line is done.
    bool work();

    // Passes `seconds`, or less up to the next moment at which something may begin; returns how
    // much.
    double advance(double seconds);

    // Everything planned ends where it stands. A line that waits for its turn to be planned still
    // runs, from there.
    void drop_planned();
    void drop_line();

    bool at_rest() const { return actions_.empty() && motion_.empty() && !waiting(); }
    bool moving() const { return !motion_.empty(); }
    double now_s() const { return now_s_; }
    double beam_power() const { return motion_.running_power().value_or(0.0); }
    std::size_t planned() const { return motion_.size(); }
    const Axes& position_mm() const { return motion_.position_mm(); }
    const Axes& planned_mm() const { return motion_.end_mm(); }
    void scale_power(double factor);
    BeamLog& beam_log() { return log_; }
    const BeamLog& beam_log() const { return log_; }

private:
    bool waiting() const { return waits_for_stand_ || busy_until_s_ > now_s_; }
    bool perform(const Action& action);

    GcodeInterpreter interpreter_;
    MotionQueue motion_;
    BeamLog log_;
    std::deque<Action> actions_;
    bool waits_for_stand_ = false;
    bool homes_ = false;
    double now_s_ = 0.0;
    double busy_until_s_ = 0.0;
};

}  // namespace leafcutter::drivers
