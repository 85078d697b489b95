// A simulated Grbl 1.1 laser controller. Pure: bytes in, bytes out, time only as it is told.
//
// Bytes arrive without loss of time in a receive buffer of 128; what doesn't fit is dropped without
// a word, as on the real one. Real-time bytes are taken out of the stream wherever they stand.

#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <string>
#include <string_view>

#include "drivers/sim/beam_log.h"
#include "drivers/sim/gcode_interpreter.h"
#include "drivers/sim/grbl_settings.h"
#include "drivers/sim/motion_queue.h"

namespace leafcutter::drivers {

struct GrblMachineOptions {
    double bed_width_mm = 600.0;
    double bed_height_mm = 400.0;
    double line_time_s = 0.0;  // How long the controller's processor takes for a line.
    // How long a write to the EEPROM takes. What arrives meanwhile is lost, real-time bytes too.
    double eeprom_time_s = 0.0;
};

class GrblMachine {
public:
    static constexpr std::size_t kRxBytes = 128;

    enum class State { Idle, Run, Hold, Jog, Home, Alarm, Door, Check, Sleep };

    // Powers up: the banner is in the first answer.
    explicit GrblMachine(const GrblMachineOptions& options = {});

    // Returns what the controller sends until now.
    std::string feed(std::string_view bytes);
    std::string advance(double seconds);

    // Nothing moves, waits or is left to read.
    bool at_rest() const;

    State state() const { return state_; }
    double now_s() const { return now_s_; }
    const Axes& position_mm() const { return motion_.position_mm(); }
    double beam_power() const;  // S put out at this moment.
    const BeamLog& beam_log() const { return log_; }
    BeamLog& beam_log() { return log_; }
    GrblSettings& settings() { return settings_; }
    std::size_t bytes_dropped() const { return bytes_dropped_; }
    std::size_t gcode_lines() const {
        return gcode_lines_;
    }  // Answered; without blank and $ lines.

    void trip_hard_limit();  // ALARM:1 at once.
    void power_cycle();      // As if the supply had failed for a moment.

private:
    // The receiving interrupt and real-time commands: grbl_realtime.cpp
    void receive(char byte);
    void realtime(unsigned char byte);
    void adjust_override(unsigned char byte);
    void feed_hold();
    void cycle_start();
    void safety_door();
    void jog_cancel();
    void soft_reset();

    void toggle_stopped_beam();
    std::string status_report();

    // Alarms and restarts: grbl_restart.cpp
    void set_alarm(int code);
    void end_alarm_delay();
    void clear_all();
    void restart();
    void greet();
    void run_startup_lines();

    // Lines: grbl_machine.cpp
    void work();
    bool blocked() const;
    bool perform(const Action& action);
    bool perform_move(const Action& action);
    void take_byte(char byte);
    void run_line();
    void answer(int error);
    void begin_beam(double power_s);
    void write_eeprom();
    void settle();
    void settle_hold();
    void expose(double until_s);
    double advance_motion(double seconds);
    GcodeInterpreter::Rules rules() const;
    MotionLimits limits() const;
    void apply_overrides();

    // `$` lines: grbl_system_commands.cpp
    int run_system_line(std::string_view line);
    int run_action_command(char command);
    int run_storing_command(const std::string& line);
    int home();
    int sleep();
    int build_info(const std::string& line);
    int startup_line(const std::string& line);
    int jog_state_error() const;
    int set_setting(std::string_view line);
    int jog(std::string_view line);
    int toggle_check();
    int restore(char what);
    bool beyond_travel(const Axes& target_mm) const;
    void finish_home();

    GrblSettings settings_;
    GcodeInterpreter interpreter_;
    MotionQueue motion_;
    BeamLog log_;
    double line_time_s_;
    double eeprom_time_s_;
    std::string build_note_;
    std::array<std::string, 2> startup_lines_;

    State state_ = State::Idle;
    bool critical_ = false;    // Alarm 1 or 2: serves nothing but a reset.
    bool soft_limit_ = false;  // Slowing down because a target lies beyond the travel.
    bool jog_flush_ = false;   // Slowing down to end a jog.
    double now_s_ = 0.0;
    double busy_until_s_ = 0.0;  // Dwell, homing, or the time a line takes.
    double held_since_s_ = 0.0;
    double alarm_until_s_ = 0.0;  // After "ALARM:n" the firmware serves nothing for a while.
    double deaf_until_s_ = 0.0;   // While the EEPROM is written, nothing is received.
    bool alarm_delay_ = false;
    bool restarting_ = false;    // A reset is under way, held up by its alarm.
    bool owes_answer_ = false;   // To the line that an alarm or a reset has cut short.
    bool status_asked_ = false;  // While homing: answered at its end.
    bool beam_stopped_ = false;  // By a hold; a resume says that it restores it.
    bool door_after_jog_ = false;
    double standing_power_ = 0.0;
    double exposed_since_s_ = 0.0;
    std::array<int, 3> override_percent_{100, 100, 100};
    int reports_to_offset_ = 0;
    int reports_to_override_ = 0;

    std::deque<char> rx_;
    std::string line_;
    bool line_overflow_ = false;
    bool in_comment_ = false;
    bool skip_to_end_ = false;
    std::deque<Action> actions_;
    bool line_pending_ = false;  // `actions_` belong to a line not yet answered.
    bool pending_is_gcode_ = false;
    std::string out_;
    std::size_t bytes_dropped_ = 0;
    std::size_t gcode_lines_ = 0;
};

}  // namespace leafcutter::drivers
