// A sheet of the stock as the search sees it.

#pragma once

#include "fab/material/stock.h"
#include "fab/nest/nest.h"
#include "fab/nest/sheet_plan.h"

namespace leafcutter::fab {

// How pieces are nested on a sheet: each grown by `grow_mm`, within `edge_mm` of the sheet's edge.
struct SheetGrowth {
    double grow_mm = 0.0;
    double edge_mm = 0.0;
};

SheetGrowth growth_of(const NestOptions& options);

// The kind's coordinates are those of the sheet, less (edge_mm - grow_mm) in both directions.
//
// Throws Error(BadOption) naming the sheet: no size, no polygon, a zone that is no polygon, or
// nothing left of it within its margins.
SheetKind sheet_kind(const StockItem& sheet, const NestOptions& options);

// What messages call it: its id, or else its size.
std::string name_of(const StockItem& sheet);

}  // namespace leafcutter::fab
