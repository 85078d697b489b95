// The whole model for a printer and scissors: every piece in true size, without kerf.
//
// Pages of ordinary paper, lying, in the order of assembly and parted by material: who prints them
// cuts a page and weaves it, and never looks for a piece through a heap. Rows rather than a dense
// nest keep that order. Pieces are never parted: those longer than the paper stand on pages of
// their own that are as long as they need, for a plotter, a print shop or a program's poster print;
// a smaller fit.max_piece_mm avoids them. Each page has a bar of 100 mm to check the print's scale.

#pragma once

#include <string>
#include <vector>

#include "fab/job_result.h"

namespace leafcutter::fab {

struct ScissorsDrawing {
    std::string all;                 // Every page side by side, pages for Inkscape too.
    std::vector<std::string> pages;  // The same, each one SVG.
};

ScissorsDrawing write_scissors(const JobResult& job);

}  // namespace leafcutter::fab
