// What lies on a sheet, read back from its G-code alone: outlines, and what is burnt inside them.
// Sheet millimetres, y up.

#pragma once

#include <string_view>
#include <vector>

#include "fab/cut/audit.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

struct BurntPiece {
    Ring contour;   // The way of the beam's centre round the piece.
    int times = 1;  // How often it was burnt: once for every pass.

    // It shares edges with others. Waste that pieces enclose comes as such a contour too.
    bool in_net = false;

    // Everything burnt inside, each line once: marks, text, slits, holes.
    std::vector<BurntSegment> marks;
};

struct BurntSheet {
    std::vector<BurntPiece> pieces;  // In the order they are cut.
    int stray_lines = 0;             // Burnt outside every piece.
};

// A program ends with its cuts, so that the power and feed of the last burn tell cuts from marks.
// Cuts that close and lie in no other one are outlines, and so are the meshes of a net of cuts that
// don't. Tabs are read across, lead-ins and over-cuts left out.
BurntSheet read_sheet(std::string_view gcode);

// True if `point` lies inside of the ring; undecided on its edge.
bool encloses(const Ring& ring, const Eigen::Vector2d& point);

}  // namespace leafcutter::fab
