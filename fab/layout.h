// Where pieces lie on sheets.

#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "fab/material/material.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

// Mirrored first (x → −x), then rotated about the piece's origin, then moved.
struct Placement {
    std::string piece;
    double x_mm = 0.0;
    double y_mm = 0.0;
    double rotation_deg = 0.0;
    bool mirrored = false;

    Eigen::Vector2d apply(const Eigen::Vector2d& point) const;
};

struct Sheet {
    int id = 1;  // Counts through all materials.
    std::string material;
    std::string family;  // "weft", "warp" or "both" where they share the material.
    SheetSize size;      // Origin at the lower left corner, y up.
    Ring outline;        // Of a remnant, within the size; empty: the whole rectangle.
    std::vector<Placement> placements;
};

struct Layout {
    std::vector<Sheet> sheets;
    std::vector<std::string> unplaced;  // Pieces larger than an empty sheet.
    double density_percent = 0.0;       // Outline area / area of the sheets used.
    double smallest_gap_mm = 0.0;       // Between two outlines of a sheet, proven exactly.
};

}  // namespace leafcutter::fab
