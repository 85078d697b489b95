// What a machine does on one sheet: paths in the order they are burnt, in sheet millimetres.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fab/material/material.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

// The machine's limits, for time estimates and for power words.
struct MachineProfile {
    double rapid_mm_per_min = 6000.0;
    double acceleration_mm_per_s2 = 500.0;
    std::optional<double> s_max;  // The S word of full power; none: what its firmware begins with.
};

// A stretch of a path that the beam leaves dark, in mm along its points.
struct DarkStretch {
    double from_mm = 0.0;
    double to_mm = 0.0;
};

struct CutPath {
    Operation operation = Operation::Cut;
    Polyline points;  // A closed path repeats its first point at the end.
    std::string piece;
    std::string other_piece = {};  // Of a common edge: whose edge it is too.

    std::optional<Eigen::Vector2d> lead_in =
        {};                              // The beam begins here and runs straight to the path.
    double over_cut_mm = 0.0;            // How much of a closed path is run again at its end.
    std::vector<DarkStretch> tabs = {};  // Bridges that hold the piece; in order, apart.
    std::optional<LaserSettings> settings = {};  // Instead of the program's for its operation.
};

// What became of the wishes for a sheet.
struct CutFacts {
    int lead_ins = 0;            // As long as wished.
    int lead_ins_shortened = 0;  // No room for more.
    int lead_ins_dropped = 0;    // No room at all.
    int tabs = 0;
    int tabs_dropped = 0;                 // No straight stretch without marks was long enough.
    double common_edges_mm = 0.0;         // Cut once for two pieces.
    double peak_heat = 0.0;               // HeatModel::peak (cut_heat.h) of the order chosen,
    double peak_heat_shortest_way = 0.0;  // and of the one that heat was not asked about.
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
    CutFacts facts;
};

}  // namespace leafcutter::fab
