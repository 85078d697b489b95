// Sheets and remnants at hand, and what is wrong with them. Lengths are millimetres.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fab/material/material.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

// Hole: material is missing, pieces keep the margin from it. Defect: pieces stay clear of it.
// KeepOut: the beam stays clear of it, by the spacing.
enum class ZoneKind { Hole, Defect, KeepOut };

struct SheetZone {
    ZoneKind kind = ZoneKind::Hole;
    Ring outline;
};

struct StockItem {
    std::string id;
    std::string material;            // Empty: whichever is asked for.
    SheetSize size;                  // Of the bounds, which start at the origin.
    Ring outline;                    // Empty: the whole rectangle.
    std::vector<SheetZone> zones;    // Within it.
    std::optional<int> quantity{1};  // None: as many as wanted.
    double cost = 0.0;               // Of one: what is at hand is paid for.
};

// Without holes and all else that pieces may not lie on, where these do not overlap.
double usable_area(const StockItem& sheet);

// Moves the outline and all zones so that the bounds start at the origin, and sets the size.
void move_to_origin(StockItem& sheet);

}  // namespace leafcutter::fab
