// The G-code of Grbl 1.1: a line in, the actions it asks for out, or the error that Grbl would
// report. Keeps the modal state; knows neither time nor motion.
//
// Follows Grbl 1.1's gcode.c in its rules: modal groups, which words a command uses, error numbers,
// and the laser mode's treatment of S. Without probing (G38).

#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/gcode_words.h"
#include "drivers/sim/motion_queue.h"

namespace leafcutter::drivers {

struct Action {
    enum class Kind {
        Move,
        Sync,    // Wait until every move has ended (the air assist is switched).
        Beam,    // Sync, then `move.beam` and `move.power_s` hold while standing.
        Dwell,   // Sync, then wait `seconds`.
        Pause,   // M0: sync, then hold until resumed.
        End,     // M2, M30: sync, then overrides back to 100 %.
        Home,    // $H
        Offset,  // The work offset changed; the next report says so.
    };
    Kind kind = Kind::Sync;
    Move move;
    double seconds = 0.0;
};

struct Interpretation {
    int error = 0;  // Grbl's error code; `actions` is empty then.
    std::vector<Action> actions;
    bool writes_eeprom = false;  // G10, G28.1, G30.1.
};

class GcodeInterpreter {
public:
    struct Block;  // gcode_block.h

    struct Rules {
        bool laser_mode = true;                // $32
        double arc_tolerance_mm = 0.002;       // $12
        std::array<double, 3> steps_per_mm{};  // Targets are rounded to whole steps.
    };

    enum class Motion { Rapid = 0, Linear = 1, ArcCw = 2, ArcCcw = 3, None = 80 };

    struct Modal {
        Motion motion = Motion::Rapid;
        int plane = 17;
        bool inches = false;
        bool relative = false;
        bool inverse_time = false;
        int coordinates = 54;
        BeamMode beam = BeamMode::Off;
        bool flood = false;
        double feed_mm_per_min = 0.0;
        double power_s = 0.0;
        int tool = 0;
    };

    Interpretation run(std::string_view stripped, const Rules& rules);

    // "$J=" without the "$J=": moves without touching the modal state.
    Interpretation run_jog(std::string_view stripped, const Rules& rules);

    // Modal state of power-up. Forgets G92; keeps G54..G59, G28, G30.
    void reset(const Axes& position_mm);
    void set_position(const Axes& position_mm) { position_mm_ = position_mm; }

    Axes work_offset_mm() const;
    double spindle_speed() const { return modal_.power_s; }
    BeamMode beam() const { return modal_.beam; }
    bool flood() const { return modal_.flood; }
    const Modal& modal() const { return modal_; }

    std::string report_modal(bool inches = false) const;    // "[GC:…]"
    std::string report_offsets(bool inches = false) const;  // The answer to $#.

private:
    int read_words(std::string_view stripped, Block& block) const;
    int check(Block& block);
    int check_non_modal(const Block& block) const;
    int check_motion(Block& block, bool motion_line) const;
    int check_arc(Block& block) const;
    void resolve_target(Block& block) const;
    void execute(Block& block, const Rules& rules, std::vector<Action>& actions);
    void execute_beam(const Block& block, const Rules& rules, std::vector<Action>& actions) const;
    void set_offsets(const Block& block);
    void execute_axes(Block& block, const Rules& rules, std::vector<Action>& actions);
    void add_line(const Block& block,
                  const Rules& rules,
                  const Axes& target,
                  std::vector<Action>& actions);
    void add_arc(const Block& block, const Rules& rules, std::vector<Action>& actions);

    Modal modal_;
    Axes position_mm_{};
    std::map<int, Axes> coordinates_{{54, {}}, {55, {}}, {56, {}}, {57, {}}, {58, {}}, {59, {}}};
    Axes g28_mm_{};
    Axes g30_mm_{};
    Axes g92_mm_{};
    double tool_length_mm_ = 0.0;
};

}  // namespace leafcutter::drivers
