// Pictures of flat pieces: one of them explained, and whole sheets.

#pragma once

#include <string>
#include <vector>

#include "fab/guide/document.h"
#include "fab/guide/job_index.h"
#include "fab/guide/pictures.h"

namespace leafcutter::fab::guide {

// A piece that shows as many kinds of marks as any, and is not too long to be drawn. Null if the
// job has no pieces.
const Piece* typical_piece(const JobResult& job);

// A piece with numbers on what is to be seen on it.
struct ExplainedPiece {
    std::vector<Drawing> drawings;    // All of it, its start, its end.
    std::vector<std::string> legend;  // In the order of the numbers, from 1.
};

ExplainedPiece explain_piece(const JobIndex& index, const Piece& piece);

// A sheet with the outlines of its pieces and their ids.
Drawing sheet_picture(const JobIndex& index, const Sheet& sheet, PictureSize size);

}  // namespace leafcutter::fab::guide
