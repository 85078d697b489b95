// Holds a burn against its plan: what a machine (simulated, or read back from G-code) burnt,
// against the sheet's outlines and marks. Lead-ins and over-cuts are planned burns; a tab that is
// burnt is a deviation.

#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "fab/cut/cut_program.h"

namespace leafcutter::fab {

struct BurntSegment {
    Eigen::Vector2d from;
    Eigen::Vector2d to;
    double power = 0.0;            // The S word; 0 where it is not known.
    double feed_mm_per_min = 0.0;  // The F word, likewise.
};

struct BurnAudit {
    double largest_deviation_mm = 0.0;  // Of any burnt point from the nearest planned path.
    double largest_gap_mm = 0.0;        // Of any planned point from the nearest burn.
    double burnt_mm = 0.0;
    double planned_mm = 0.0;
};

BurnAudit audit_burn(const CutProgram& plan, std::span<const BurntSegment> burnt);

// The segments that a G-code program of ours burns (G0, G1, M3/M4/M5, S, F), read back from its
// text. A program that never turns the laser on (Smoothieware) burns with the power word alone.
std::vector<BurntSegment> burnt_segments(std::string_view gcode);

}  // namespace leafcutter::fab
