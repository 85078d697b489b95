#include "fab/material/stock.h"

#include <algorithm>
#include <cmath>

#include "fab/material/totals.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

double usable_area(const StockItem& sheet) {
    double area = sheet.outline.empty() ? sheet.size.width_mm * sheet.size.height_mm
                                        : std::abs(signed_area(sheet.outline));
    for (const SheetZone& zone : sheet.zones) {
        area -= std::abs(signed_area(zone.outline));
    }
    return area;
}

void move_to_origin(StockItem& sheet) {
    if (sheet.outline.empty()) {
        return;
    }
    Eigen::Vector2d low = sheet.outline.front();
    Eigen::Vector2d high = low;
    for (const Eigen::Vector2d& point : sheet.outline) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    const auto shift = [&low](Ring& ring) {
        for (Eigen::Vector2d& point : ring) {
            point -= low;
        }
    };
    shift(sheet.outline);
    for (SheetZone& zone : sheet.zones) {
        shift(zone.outline);
    }
    sheet.size = {high.x() - low.x(), high.y() - low.y()};
}

}  // namespace leafcutter::fab
