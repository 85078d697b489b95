// What a cut sheet leaves whole, for another job.

#pragma once

#include <span>

#include "fab/layout.h"
#include "fab/material/stock.h"
#include "fab/nest/free_rectangle.h"

namespace leafcutter::fab {

// About the largest rectangle along the axes within the sheet's outline and clear of its zones; of
// no size if there is none.
FreeRectangle largest_rectangle(const StockItem& sheet);

// Gives each sheet that leaves something its offcut: the largest part of it that is nowhere
// narrower than 30 mm, clear of pieces by the kerf and of zones; at least 30 x 60 mm fit into it.
void add_offcuts(Layout& layout, std::span<const Piece* const> pieces, double kerf_mm);

}  // namespace leafcutter::fab
