// Bridges that hold a piece in its sheet until it is broken out: stretches of its contour that are
// left uncut.

#pragma once

#include <span>

#include "fab/cut/cut_program.h"
#include "fab/nest/collision.h"

namespace leafcutter::fab {

struct TabOptions {
    int count = 0;
    double length_mm = 0.5;
};

// Gives the contour `whole`, which the `paths` are all or a part of, its tabs: the first near the
// end of a long piece, the others evenly round, each on the nearest straight stretch clear of
// corners and of `lines` (marks and slits of the piece, contours of others). Returns how many found
// a place.
int add_tabs(const Polyline& whole,
             std::span<CutPath* const> paths,
             std::span<const Segment> lines,
             const TabOptions& options);

}  // namespace leafcutter::fab
