// What a machine does on one sheet: paths in the order they are burnt, in sheet millimetres.

#pragma once

#include <string>
#include <vector>

#include "fab/material/material.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

// The machine's limits, for time estimates and for power words.
struct MachineProfile {
    double rapid_mm_per_min = 6000.0;
    double acceleration_mm_per_s2 = 500.0;
    double s_max = 1000.0;  // The S word of full power ($30).
};

struct CutPath {
    Operation operation = Operation::Cut;
    Polyline points;  // A closed path repeats its first point at the end.
    std::string piece;
};

struct CutProgram {
    std::string job;
    int sheet = 1;
    std::string material;
    SheetSize size;
    LaserSettings cut;
    LaserSettings score;
    LaserSettings engrave;
    std::vector<CutPath> paths;  // Engrave, then score, then cut; inner contours before outer.

    double burn_mm = 0.0;
    double travel_mm = 0.0;
    double estimated_s = 0.0;
};

}  // namespace leafcutter::fab
