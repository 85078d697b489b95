// A simulated Smoothieware laser controller. Pure: bytes in, bytes out, time only as it is told.
//
// After Smoothieware's GcodeDispatch.cpp, USBSerial.cpp, Laser.cpp and Robot.cpp: a line is
// answered with ok, a G1 even before it is planned; a wrong sum or number with "rs N…"; lines while
// halted with "!!". ? and Ctrl-X act when they arrive; ! and ~ only where feed hold is configured,
// and hold only what isn't planned yet. The beam needs no M word: it is on in G1, G2 and G3 while
// they move, with the last S, at a power that follows the speed. A halt stops the motors dead.

#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <string_view>

#include "drivers/sim/gcode_runner.h"
#include "drivers/sim/sim_machine.h"

namespace leafcutter::drivers {

struct SmoothieMachineOptions {
    bool grbl_mode = false;
    bool feed_hold = false;  // By default that of grbl_mode on the board.
};

class SmoothieMachine final : public SimMachine {
public:
    // Powers up: "Smoothie" and "ok" are in the first answer.
    explicit SmoothieMachine(const SmoothieMachineOptions& options = {});

    std::string feed(std::string_view bytes) override;
    std::string advance(double seconds) override;
    bool at_rest() const override;
    double now_s() const override { return runner_.now_s(); }
    double beam_power() const override;
    const BeamLog& beam_log() const override { return runner_.beam_log(); }
    BeamLog& beam_log() override { return runner_.beam_log(); }
    void power_cycle() override;

    bool halted() const { return halted_; }
    const Axes& position_mm() const { return runner_.position_mm(); }

private:
    void receive(char byte);
    void work();
    void take_line(const std::string& line);
    void take_command(const std::string& text);
    void run_m(int code, const std::string& stripped);
    void run_shell(const std::string& line);
    void fire(const std::string& line);
    void burn_standing(double seconds);
    void halt();
    void unhalt();
    void fail(std::string_view what);
    void report();
    std::string position() const;

    SmoothieMachineOptions options_;
    GcodeRunner runner_;
    std::string out_;
    std::deque<char> rx_;
    std::size_t lines_in_rx_ = 0;
    bool line_pending_ = false;  // Not yet answered.
    std::string answer_;         // What follows its ok.
    bool halted_ = false;
    bool holds_ = false;
    long last_number_ = -1;
    double fire_power_ = 0.0;  // By hand; 0: off.
    double fire_until_s_ = 0.0;
};

}  // namespace leafcutter::drivers
