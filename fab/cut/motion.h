// A cut program as the moves that a machine makes, one by one, with every pass. What the G-code
// writer spells out, the time estimate adds up.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "fab/cut/cut_program.h"

namespace leafcutter::fab {

struct Motion {
    Eigen::Vector2d to;
    double feed_mm_per_min = 0.0;
    double power_percent = 0.0;
    bool burns = false;  // False: a rapid with the beam off.
};

const LaserSettings& settings_of(const CutProgram& program, const CutPath& path);

// From the origin through all paths and back to the origin. A pass over an open path runs against
// the one before it; a closed path goes round again. A lead-in is burnt before the first pass, an
// over-cut after the last; tabs are rapids.
std::vector<Motion> motions(const CutProgram& program, const MachineProfile& machine);

}  // namespace leafcutter::fab
