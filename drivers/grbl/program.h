// A G-code file made ready for Grbl: comments and blanks gone, every line checked before the beam
// may be lit.

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/device.h"
#include "drivers/grbl/protocol.h"

namespace leafcutter::drivers {

struct ProgramLine {
    std::string text;
    std::size_t number = 0;  // In the file, from 1.
    bool alone = false;      // Touches the EEPROM: sent with nothing else under way.
    double dwell_s = 0.0;    // G4: the machine stands this long on purpose.
};

struct Program {
    std::vector<ProgramLine> lines;
};

// Throws ProgramRefused, naming the line, for a line that Grbl can't take: longer than its line
// buffer, words that can't be read, `$` commands, bytes that Grbl takes for real-time commands.
Program read_program(std::string_view text, std::size_t longest_line = GrblProtocol::kMaxLine);

// What lights a machine's beam so that it goes out by itself wherever the head stands.
enum class BeamCommand {
    M4,        // Grbl in laser mode.
    InlineM4,  // Marlin: M4 I.
    None       // Smoothieware: its beam goes with G1, G2 and G3.
};

// What a program is held against. Lengths in mm.
struct MachineFacts {
    BeamCommand beam = BeamCommand::M4;
    bool laser_mode = false;            // $32; of Grbl alone.
    bool reports_inches = false;        // $13
    std::optional<double> s_max;        // $30
    double power_cap_percent = 100.0;   // Of s_max; a higher S is refused.
    std::array<double, 2> travel_mm{};  // $130, $131; 0: unknown.
    // Where the work origin lies in the travel, 0 at its low end; unknown without homing.
    std::optional<std::array<double, 2>> origin_in_travel_mm;
    std::array<double, 2> work_position_mm{};
};

// Throws ProgramRefused with the line, or Refused for the machine's settings, and what to do.
// No M3: with it the beam stays lit where the machine stands once its sender dies (of Marlin 2.1,
// too, only M4 I goes out when the planner is empty: stepper.cpp).
void preflight(const Program& program, const MachineFacts& machine);

}  // namespace leafcutter::drivers
