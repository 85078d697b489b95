// Where pieces lie on sheets.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fab/material/material.h"
#include "fab/material/stock.h"
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

// What a cut sheet leaves whole: good for another job.
struct Offcut {
    std::string id;           // Of its own in the layout.
    Ring outline;             // In the sheet's coordinates, clear of pieces by the kerf.
    std::vector<Ring> holes;  // In it.
    double area_mm2 = 0.0;    // Without them.
    Eigen::Vector2d corner;   // Of the largest rectangle found in it: lower left,
    SheetSize rectangle;      // and how large.
};

struct Sheet {
    int id = 1;  // Counts through all materials.
    std::string material;
    std::string family;  // "weft", "warp" or "both" where they share the material.
    SheetSize size;      // Origin at the lower left corner, y up.
    Ring outline;        // Of a remnant, within the size; empty: the whole rectangle.
    std::vector<Placement> placements;
    std::string stock = {};             // Entry of the stock that it is of; empty: a new sheet.
    double cost = 0.0;                  // Of a sheet of the stock.
    std::vector<SheetZone> zones = {};  // That pieces keep clear of.
    std::optional<Offcut> offcut = {};
};

struct Layout {
    std::vector<Sheet> sheets;
    std::vector<std::string> unplaced;  // Pieces that found no room on any sheet.
    double density_percent = 0.0;       // Outline area / area of the sheets used.
    double smallest_gap_mm = 0.0;       // Between two outlines of a sheet, proven exactly.
};

}  // namespace leafcutter::fab
