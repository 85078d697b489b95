// Weft and warp strips of a quad mesh, unfolded exactly and made into pieces that can be cut.

#pragma once

#include <span>
#include <string>
#include <vector>

#include "fab/job_params.h"
#include "fab/material/material.h"
#include "fab/strips/crossings.h"
#include "fab/strips/strip.h"
#include "geometry/context.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

// Ids "W1"… and "P1"…, weft first, each family ordered by smallest quad.
std::vector<Strip> make_strips(const geometry::QuadMesh& mesh, ColumnRuns columns);

struct PieceLimits {
    SheetSize usable_sheet;  // A piece's outline must fit into it at some rotation.
    double thickness_mm = 0.2;
    double min_width_mm = 1.0;
    double min_length_mm = 0.0;          // Of a piece, along its middle.
    Rotation rotation = Rotation::Free;  // The rotations that may make it fit.
    double self_gap_mm = 0.5;            // Distant parts of an outline stay this far apart.
    double kerf_mm = 0.1;
};

struct PieceRules {
    const FitParams& fit;
    const PieceLimits& limits;
    std::span<const Crossing> crossings;  // Of the strip, per cell.
};

// Unfolds `strip` and parts it where it is closed, over-long or would overlap itself; adds
// clearance, crimp allowance and tabs; marks come later (marks.h). Sets strip.pieces. Outlines
// never overlap themselves.
std::vector<Piece> make_pieces(Strip& strip,
                               const geometry::QuadMesh& mesh,
                               const PieceRules& rules,
                               std::vector<std::string>& warnings);

}  // namespace leafcutter::fab
