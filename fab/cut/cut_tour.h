// A short open tour through stops, each of which can be entered at one of several points, some of
// them only after others.

#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "geometry/context.h"

namespace leafcutter::fab {

struct TourStart {
    Eigen::Vector2d entry;
    Eigen::Vector2d exit;
    std::size_t point = 0;  // The caller's name for it.
};

struct TourPlace {
    bool open = false;              // Two starts, each the other one reversed.
    std::vector<TourStart> starts;  // At least one. Of a closed place: entry and exit are the same.
};

struct TourProblem {
    Eigen::Vector2d from = Eigen::Vector2d::Zero();  // Where the tour begins. It ends anywhere.
    std::vector<TourPlace> places;
    std::vector<std::pair<std::size_t, std::size_t>>
        before;  // The first, then the second. No ring.

    // How many distances may be looked at to improve the tour once no single move does. The whole
    // takes about 10 ns for each.
    std::int64_t evaluations = 0;
};

struct TourStop {
    std::size_t stop = 0;   // Into the places.
    std::size_t start = 0;  // Into its starts.
};

// Every place once. Deterministic.
std::vector<TourStop> shortest_tour(const TourProblem& problem, const geometry::Context& context);

}  // namespace leafcutter::fab
