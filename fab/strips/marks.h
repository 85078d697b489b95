// What is engraved and scored on a piece, on the side that faces outward in the end:
// - at both ends its id with an arrow, "W12.1>": the text runs the way the strip is walked, the
//   arrow's flag lies on the left of it (seen from inside it would lie on the right);
// - at an end with a tab the id of the piece that is glued there, "+W12.2";
// - ticks at both ends of every rung, so between crossings, or lines over the whole rung;
// - a bar across each cell that lies under its crossing strip; cells without one lie over it;
// - ids of crossing strips, where counting from one to the next is easy;
// - scores on the diagonals of cells that bend sharply, lines where tabs begin.
// Ids stand on cells that lie under others where they are large enough there: what is woven shows
// few of them. All of it lies strictly inside the outline and nothing touches anything else.

#pragma once

#include <span>
#include <string>
#include <vector>

#include "fab/job_params.h"
#include "fab/strips/crossings.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

// What found no room.
struct MarksLeftOut {
    int rungs = 0;        // Without ticks: cells shorter than a tick's distance.
    int weave_marks = 0;  // Cells that lie under without a bar.
    std::vector<std::string> unnamed_strips;  // With a piece without any label.
};

// Marks every one of `pieces`, which are those of `strips`, behind the marks that they have. What
// had to be left out is also told in `warnings`, each kind once.
MarksLeftOut mark_pieces(std::span<Piece> pieces,
                         std::span<const Strip> strips,
                         const Crossings& crossings,
                         const FitParams& fit,
                         std::vector<std::string>& warnings);

struct LegendEntry {
    std::string symbol;             // What is seen, in words: "W12.1 with an arrow".
    std::string meaning;            // What it tells, one line.
    std::vector<Polyline> picture;  // In a box of height 1 from the origin, y up.
};

// The kinds of marks that `fit` asks for, in the order of reading.
std::vector<LegendEntry> mark_legend(const FitParams& fit = {});

}  // namespace leafcutter::fab
