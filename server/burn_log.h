// Beam logs of the simulated machines: JSON lines {"x0", "y0", "x1", "y1", "s", …} in machine mm,
// one for each piece of motion with the beam on.

#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "drivers/sim/beam_log.h"
#include "fab/cut/audit.h"

namespace leafcutter::server {

// Places and S words of the lit pieces. Throws geometry::Error(BadFile) naming the line.
std::vector<drivers::BurntPiece> read_burnt_pieces(std::string_view text);

// The same. Throws geometry::Error(BadFile) naming the line.
std::vector<fab::BurntSegment> read_burn_log(std::string_view text);

// Parts a log of several sheets, cut one after the other, where the burnt length of each plan is
// reached; the last part gets whatever is left. One part for each plan.
std::vector<std::vector<fab::BurntSegment>> part_by_sheet(std::span<const fab::BurntSegment> burnt,
                                                          std::span<const fab::CutProgram> plans);

}  // namespace leafcutter::server
