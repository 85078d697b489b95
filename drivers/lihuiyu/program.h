// A cut as a Lihuiyu board can make it: straight moves with the beam on or off, each at one speed.
// The board has no control of power: that is set by the knob or the panel of the machine.

#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace leafcutter::drivers {

// From the end of the move before; the first from the program's origin.
struct CutMove {
    double x_mm = 0.0;
    double y_mm = 0.0;
    bool beam = false;
    double speed_mm_per_s = 0.0;  // Of moves with the beam on; others go as fast as the board can.
    std::size_t line = 0;         // Of the file it was read from, from 1; 0: none.
};

// Reads G0 to G3, G20, G21, G90, G91, M3, M4, M5 and the end of program. The beam is on in G1 to G3
// after M3 or M4 with an S above 0; how high S is doesn't matter. Arcs become chords that leave
// them by at most half a step. Throws ProgramRefused, naming the line, for anything else that would
// move or light the machine, and for a burning move without a feed.
std::vector<CutMove> read_cut_moves(std::string_view gcode);

}  // namespace leafcutter::drivers
