// How truly the cut pieces give the surface back, measured on the G-code itself.
//
// The program of each sheet is read back; its burns are chained to contours. Each placed piece
// finds its contour, which is moved back into the piece's frame and shrunk by half the kerf. There
// every rung end looks up the nearest burnt point; by how far that misses the planned one, the
// exactly unfolded rung end is moved. Between the rung ends so rebuilt, every edge of the piece's
// cells is measured and held against the same edge of the quad mesh in space; the largest
// difference over the mean edge of the mesh is the relative deviation.
//
// So what counts is everything between mesh and beam: unfolding, placement, kerf offset, rounding
// of numbers, notches narrower than the kerf (the beam leaves them filled), pieces left out (they
// deviate by 1). Clearance and crimp are allowances and cancel out. A slip along a straight side is
// seen at its ends only.

#pragma once

#include <span>
#include <string>

#include "fab/job_result.h"

namespace leafcutter::fab {

// `gcode` holds the program of each sheet of job.layout, in the same order; job.certificate is not
// read.
Certificate certify(const JobResult& job, std::span<const std::string> gcode);

}  // namespace leafcutter::fab
