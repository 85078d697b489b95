// A short open tour through stops, each of which can be entered at one of several points.

#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "geometry/context.h"

namespace leafcutter::fab {

struct TourStart {
    Eigen::Vector2d entry;
    Eigen::Vector2d exit;
    std::size_t point = 0;  // The caller's name for it.
};

struct TourStop {
    std::size_t stop = 0;
    std::size_t start = 0;  // Into the stop's starts.
};

// Visits every stop once, beginning at `from`, ending anywhere. A stop with two starts is open:
// each start is the other one reversed. Any other stop is closed: entry and exit of a start are the
// same.
std::vector<TourStop> shortest_tour(const std::vector<std::vector<TourStart>>& stops,
                                    const Eigen::Vector2d& from,
                                    const geometry::Context& context);

}  // namespace leafcutter::fab
