// Lengths, areas and weight of a job's strips.

#pragma once

#include "fab/job_result.h"

namespace leafcutter::fab {

// Length of a piece's middle line, without tab.
double piece_length_mm(const Piece& piece);

struct FamilyTotals {
    int strips = 0;
    int closed = 0;
    int pieces = 0;
    double length_mm = 0.0;
    double area_mm2 = 0.0;  // Of the outlines, with tabs.
    double weight_g = 0.0;
};

FamilyTotals total_of(const JobResult& job, Family family);

}  // namespace leafcutter::fab
