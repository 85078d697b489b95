// A simulated Marlin 2 laser controller. Pure: bytes in, bytes out, time only as it is told.
//
// After Marlin 2.0's queue.cpp and e_parser.h: 128 bytes of receive buffer, what doesn't fit is
// lost; four lines of queue; a wrong sum or number is answered with Error and Resend, and what was
// received behind it is thrown away. The emergency parser sees M112 and M410 as they arrive. M410
// empties the planner and takes nothing for a second; a move that waits to be planned is not in the
// planner, and runs afterwards, from where the head stands: with its beam.

#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <string>
#include <string_view>

#include "drivers/sim/gcode_runner.h"
#include "drivers/sim/sim_machine.h"

namespace leafcutter::drivers {

struct MarlinMachineOptions {
    bool emergency_parser = true;
    bool advanced_ok = false;
    bool ok_after_resend = true;  // Versions differ.
    bool keeps_alive = true;      // "busy" while a line takes long.
    bool knows_m118 = true;       // Repeats a text.
    bool knows_lasers = true;     // Else M3, M4 and M5 are unknown commands.
    double temperature_every_s = 0.0;
    std::array<double, 2> bed_mm{};  // As M115 says it; 0: it doesn't.
};

class MarlinMachine final : public SimMachine {
public:
    static constexpr std::size_t kLines = 4;
    static constexpr std::size_t kRxBytes = 128;

    // Powers up: "start" is in the first answer.
    explicit MarlinMachine(const MarlinMachineOptions& options = {});

    std::string feed(std::string_view bytes) override;
    std::string advance(double seconds) override;
    bool at_rest() const override;
    double now_s() const override { return runner_.now_s(); }
    double beam_power() const override;
    const BeamLog& beam_log() const override { return runner_.beam_log(); }
    BeamLog& beam_log() override { return runner_.beam_log(); }
    void power_cycle() override;

    bool killed() const { return killed_; }
    const Axes& position_mm() const { return runner_.position_mm(); }
    std::size_t bytes_dropped() const { return bytes_dropped_; }

private:
    struct Line {
        std::string text;
        std::size_t number = 0;
    };

    void watch_emergency(char byte);
    void read();
    void take_line(std::string_view line);
    void ask_again(std::string_view why);
    void work();
    void run(const std::string& line);
    bool run_own(const std::string& line, const std::string& stripped);
    void quick_stop();
    void answer();
    void kill();
    void keep_alive();

    MarlinMachineOptions options_;
    GcodeRunner runner_;
    std::string out_;
    std::deque<char> rx_;
    std::string partial_;
    std::string emergency_;  // The line as it arrives.
    std::deque<Line> queue_;
    std::size_t running_ = 0;    // Number of the line at work.
    bool line_pending_ = false;  // It is not yet answered.
    bool killed_ = false;
    double cleaning_until_s_ = 0.0;
    std::size_t last_number_ = 0;
    std::size_t bytes_dropped_ = 0;
    double busy_told_s_ = 0.0;
    double busy_every_s_ = 2.0;
    double temperature_told_s_ = 0.0;
};

}  // namespace leafcutter::drivers
