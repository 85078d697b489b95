// From moves in mm to the packets of a Lihuiyu board.
//
// A program is "I", then sections, then "FNSE". A section is one speed and the way to its start:
// speed code, steps to go (rapid), "NRBS1E", runs of steps. Between two sections stands "@NSE".
// Lines of any slope become runs along the axes and diagonals that leave the line by at most half a
// step. Every end of a move is rounded from its absolute place, so errors never add up.

#pragma once

#include <vector>

#include "drivers/lihuiyu/packer.h"
#include "drivers/lihuiyu/packet.h"
#include "drivers/lihuiyu/program.h"
#include "drivers/lihuiyu/runs.h"
#include "drivers/lihuiyu/speed_code.h"

namespace leafcutter::drivers {

struct LihuiyuBed {
    double width_mm = 310.0;
    double height_mm = 210.0;
    double steps_per_mm = 1000.0 / 25.4;
    // Where a program's origin lies, from the home corner (top left): right and down. A program's y
    // goes up. By default the lower left corner of the bed.
    double origin_x_mm = 0.0;
    double origin_down_mm = 210.0;
};

StepPlace to_steps(const LihuiyuBed& bed, double x_mm, double y_mm);

struct PlaceMm {
    double x_mm = 0.0;
    double y_mm = 0.0;
};
PlaceMm to_program_mm(const LihuiyuBed& bed, const StepPlace& place);

struct EncoderOptions {
    SpeedModel speed;
    LihuiyuBed bed;
    double longest_burn_s = 0.5;   // Of one packet.
    double rapid_mm_per_s = 80.0;  // For estimates; the board's own.
};

// `start` is where the head stands. Throws ProgramRefused, naming the line, for a place off the bed
// or a speed that the board doesn't have.
EncodedJob encode_job(const std::vector<CutMove>& moves,
                      const StepPlace& start,
                      const EncoderOptions& options = {});

// A rapid move by itself: "I…S1P", split into packets.
std::vector<Payload> encode_rapid(const StepPlace& from, const StepPlace& to);

}  // namespace leafcutter::drivers
