// Weft and warp strips of a quad mesh, unfolded exactly and made into pieces that can be cut.

#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "fab/job_params.h"
#include "fab/material/material.h"
#include "fab/strips/crossings.h"
#include "fab/strips/joints.h"
#include "fab/strips/strip.h"
#include "fab/strips/through.h"
#include "geometry/context.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

// Ids "W1"… and "P1"…, weft first, each family ordered by smallest quad. `limits` tell how far
// warp strips run on with ColumnRuns::Through.
std::vector<Strip> make_strips(const geometry::QuadMesh& mesh,
                               ColumnRuns columns,
                               const ThroughLimits& limits = {});

struct PieceLimits {
    SheetSize usable_sheet;  // A piece's outline must fit into it at some rotation.
    double thickness_mm = 0.2;
    double min_width_mm = 1.0;
    double min_length_mm = 0.0;          // Of a piece, along its middle.
    Rotation rotation = Rotation::Free;  // The rotations that may make it fit.
    double self_gap_mm = 0.5;            // Distant parts of an outline stay this far apart.
    double kerf_mm = 0.1;
    double crossed_mm = 0.2;     // Thickness of the strips that cross.
    double min_radius_mm = 0.0;  // Tightest bend that the material takes.
};

struct PieceRules {
    const FitParams& fit;
    const PieceLimits& limits;
    std::span<const Crossing> crossings;     // Of the strip, per cell.
    JointMap* joints = nullptr;              // If given, joints keep away from those in it, and are
                                             // added to it.
    std::span<const double> threading = {};  // Of the strip: opening_costs; may be empty.
};

// How far warp strips may run on through critical leaves: they stay single pieces.
ThroughLimits through_limits(const FitParams& fit, const PieceLimits& limits);

// Throws Error(BadOption, "strip-too-narrow") if a strip is narrower than a fifth of its material's
// least width over most of its length, naming those that are. `limits` are those of weft and warp.
void refuse_hopeless_strips(std::span<const Strip> strips,
                            const geometry::QuadMesh& mesh,
                            const std::array<PieceLimits, 2>& limits);

// Unfolds `strip` and parts it where it is closed, over-long or would overlap itself; adds
// clearance, crimp allowance and tabs, and widens it to its least width; what the tabs are joined
// to and marks come later (link.h, marks.h). Sets strip.pieces. Outlines never overlap themselves.
std::vector<Piece> make_pieces(Strip& strip,
                               const geometry::QuadMesh& mesh,
                               const PieceRules& rules,
                               std::vector<std::string>& warnings);

}  // namespace leafcutter::fab
