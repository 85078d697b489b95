// Takes an order of little travel and makes it cooler for a little more.

#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "fab/cut/cut_heat.h"
#include "geometry/context.h"

namespace leafcutter::fab {

struct CoolingTask {
    const HeatModel& model;
    Eigen::Vector2d from = Eigen::Vector2d::Zero();

    // As for the order: what comes before what, and where closed paths may start.
    std::vector<std::pair<std::size_t, std::size_t>> before = {};
    std::vector<std::vector<double>> starts_mm = {};

    // The peak that is aimed at is this much lower than the given order's, of 1. What it may cost
    // grows until it is reached or nothing helps.
    double heat = 0.5;
};

// Hot paths start elsewhere, run the other way round, or come earlier or later. Deterministic.
std::vector<OrderedPath> cooled(const CoolingTask& task,
                                std::vector<OrderedPath> order,
                                const geometry::Context& context);

}  // namespace leafcutter::fab
