// Lines on a grid of steps, as runs in eight directions, and their spelling in LHYMICRO-GL.

#pragma once

#include <string>
#include <vector>

namespace leafcutter::drivers {

// Steps from the home corner: right, and away from it. Or a way between two places.
struct StepPlace {
    long x = 0;
    long y = 0;
};

inline bool operator==(const StepPlace& a, const StepPlace& b) {
    return a.x == b.x && a.y == b.y;
}

struct Run {
    int dx = 0;  // -1, 0 or 1 per step.
    int dy = 0;
    long length = 0;
};

// The runs of a straight line along `way`: along its main axis, diagonal where the other one moves
// on. No point of them is more than half a step off the line along the other axis.
std::vector<Run> runs_of_line(const StepPlace& way);

// a..y, |a..|z, three digits, with z for every 255; nothing for 0.
std::string encode_distance(long steps);

// Letters and distances of a way along both axes.
std::string encode_way(const StepPlace& way);

}  // namespace leafcutter::drivers
