// How evenly large the cells of a foliation are on the surface, before any grid is chosen.

#pragma once

#include <span>

#include "geometry/foliation.h"

namespace leafcutter::geometry {

// A part of the surface: its area there and in the flat metric of the foliation (g, f).
struct FlatArea {
    double surface = 0.0;
    double flat = 0.0;
};

// Cells are squares of the flat metric.
CellSpread cell_spread(std::span<const FlatArea> parts);

// Of finished charts; each cylinder's chart is in its own unit, as the foliation has it.
CellSpread cell_spread(std::span<const Cylinder> cylinders);

}  // namespace leafcutter::geometry
