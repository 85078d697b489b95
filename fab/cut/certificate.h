// The closed loop: how truly what is cut gives the planned surface back, by the G-code itself.
//
// From the programs of the sheets alone (no layout, no drawing): outlines and marks are read
// (sheet_reader.h), the ids engraved on them are read (text_reader.h) and name the pieces. Each
// contour, half the kerf taken off, is laid onto its piece's outline by a rigid motion
// (registration.h); rung ends are found on it with the help of its ticks, and the lengths between
// them measured (piece_measure.h). All lengths of all strips together are woven in the computer
// (virtual_weave.h), and the surface that comes out is held against the quad mesh.
//
// Pieces whose id is not there or can't be read are found by their shape among those that nobody
// claims; `matched_by` tells. Congruent pieces can't be told apart by shape and need not be.
//
// What is taken from the plan: the quad mesh and its strips, which cells a piece has, where on the
// outline its rungs are to be looked for, and how much of a length is allowance for thickness and
// clearance.

#pragma once

#include <span>
#include <string>

#include "fab/job_result.h"
#include "geometry/context.h"

namespace leafcutter::fab {

// `gcode` holds the programs of all sheets, in any order; of `job`, layout, programs and
// certificate are not read. Throws geometry::Error(BadFile) for G-code that is not ours.
Certificate certify(const JobResult& job,
                    std::span<const std::string> gcode,
                    const geometry::Context& context = {});

}  // namespace leafcutter::fab
