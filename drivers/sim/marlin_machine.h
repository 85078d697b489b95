// A simulated Marlin 2 laser controller. Pure: bytes in, bytes out, time only as it is told.
//
// Lines are numbered and summed as Marlin's queue does it: a wrong sum or number is answered with
// Error and Resend, and so is everything behind it until that line comes. Four lines of buffer;
// moves and beam are those of the simulated Grbl controller (inline power, dynamic).

#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/sim/beam_log.h"
#include "drivers/sim/gcode_interpreter.h"
#include "drivers/sim/motion_queue.h"
#include "drivers/sim/sim_machine.h"

namespace leafcutter::drivers {

struct MarlinMachineOptions {
    bool emergency_parser = true;
    bool advanced_ok = false;
    bool ok_after_resend = true;           // Versions differ.
    std::optional<std::size_t> flip_bit;   // In this received line, counted from 1.
    std::optional<std::size_t> drop_ok;    // The answer to this line is never sent.
    std::optional<std::size_t> drop_line;  // This line is never heard.
};

class MarlinMachine final : public SimMachine {
public:
    static constexpr std::size_t kLines = 4;

    // Powers up: "start" is in the first answer.
    explicit MarlinMachine(const MarlinMachineOptions& options = {});

    std::string feed(std::string_view bytes) override;
    std::string advance(double seconds) override;
    bool at_rest() const override { return queue_.empty() && actions_.empty() && motion_.empty(); }
    double now_s() const override { return now_s_; }
    double beam_power() const override;
    const BeamLog& beam_log() const override { return log_; }
    BeamLog& beam_log() override { return log_; }

    bool killed() const { return killed_; }
    const Axes& position_mm() const { return motion_.position_mm(); }
    std::size_t overruns() const { return overruns_; }  // Lines that found every buffer taken.

private:
    void take_line(std::string line);
    void emergency(std::string_view line);
    void ask_again(std::string_view why);
    void work();
    void run(const std::string& line);
    void run_own(std::string_view line);
    bool perform(const Action& action);
    void answer();
    void kill();

    MarlinMachineOptions options_;
    GcodeInterpreter interpreter_;
    MotionQueue motion_;
    BeamLog log_;
    std::string out_;
    std::string partial_;
    struct Line {
        std::string text;
        std::size_t number = 0;
    };
    std::deque<Line> queue_;
    std::size_t running_ = 0;  // Number of the line that `actions_` belong to.
    std::deque<Action> actions_;
    bool line_pending_ = false;  // `actions_` belong to a line not yet answered.
    bool waits_for_stand_ = false;
    bool killed_ = false;
    std::size_t last_number_ = 0;
    std::size_t heard_ = 0;
    std::size_t answered_ = 0;
    std::size_t overruns_ = 0;
    double now_s_ = 0.0;
    double busy_told_s_ = 0.0;
};

}  // namespace leafcutter::drivers
