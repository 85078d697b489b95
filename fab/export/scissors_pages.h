// Which piece stands where on the pages for scissors.

#pragma once

#include <vector>

#include "fab/job_result.h"
#include "fab/nest/shape.h"

namespace leafcutter::fab {

struct PlacedPiece {
    const Piece* piece = nullptr;
    Pose pose;  // Into the page: mm, origin at its lower left corner, y up.
};

struct ScissorsPage {
    SheetSize size;
    Family family = Family::Weft;
    bool fits_paper = true;  // Else it is as large as its pieces need.
    std::vector<PlacedPiece> pieces;
};

constexpr double kPageMarginMm = 8.0;
constexpr double kPageFootMm = 10.0;  // For the bar and the page's name.
constexpr double kPieceNameMm = 3.0;  // Height of the words over a piece without readable marks.

// True if an id of at least readable height is among the piece's marks.
bool bears_name(const Piece& piece);

// Every piece once; weft before warp, in the order of assembly.
std::vector<ScissorsPage> scissors_pages(const JobResult& job);

}  // namespace leafcutter::fab
