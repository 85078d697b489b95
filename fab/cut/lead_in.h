// Where the beam may begin beside a contour: a short straight way through the waste, clear of every
// piece and within the sheet.

#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fab/layout.h"
#include "fab/nest/collision.h"

namespace leafcutter::fab {

class LeadInRoom {
public:
    // `outlines` of all pieces on the sheet, as they are placed.
    LeadInRoom(const Sheet& sheet, std::span<const Ring> outlines, double kerf_mm);

    // Lead-ins stay half a millimetre away from it: a tab that is burnt from beside holds nothing.
    void keep_from(const Segment& tab);

    // A place to begin at, `length_mm` from the point of `points` at `at_mm`; the waste lies on the
    // right hand of the path. None if there is no room in any direction.
    std::optional<Eigen::Vector2d> begin(const Polyline& points,
                                         double at_mm,
                                         double length_mm) const;

private:
    bool is_free(const Eigen::Vector2d& begin, const Eigen::Vector2d& start) const;

    PlacedOutlines outlines_;
    PlacedOutlines tabs_;
    Eigen::Vector2d extent_;
    Ring remnant_;
    double kerf_mm_;
};

}  // namespace leafcutter::fab
