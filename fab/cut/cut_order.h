// The order in which paths are burnt, where closed ones start, and which way round they run: as
// little travel between them as can be had quickly, or a little more and less heat in one place.

#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "fab/cut/cut_heat.h"
#include "fab/cut/cut_program.h"
#include "geometry/context.h"

namespace leafcutter::fab {

struct OrderRules {
    // The path of the first number comes before that of the second. A closed path comes after
    // every path that it encloses, without being told.
    std::vector<std::pair<std::size_t, std::size_t>> before;

    // Where each closed path may start, in mm along its points; for a path without any, or if all
    // is empty: at start_places.
    std::vector<std::vector<double>> starts_mm;

    double heat = 0.0;  // 0: travel alone; 1: as cool as can be. See cut_cooling.h.
    HeatOptions cooling;

    // Distances looked at for each path to improve the tour; a sheet of many paths gets fewer.
    std::int64_t evaluations_each = 60'000;
};

// Points of a closed path that are worth starting at: its corners, and long edges parted.
std::vector<double> start_places(const CutPath& path);

// Every path of `paths` exactly once; open ones may be reversed, closed ones may start anywhere and
// run either way. All paths are of one operation. The tour begins at `from` and ends anywhere.
// Deterministic.
std::vector<OrderedPath> find_order(const std::vector<CutPath>& paths,
                                    const Eigen::Vector2d& from,
                                    const OrderRules& rules = {},
                                    const geometry::Context& context = {});

CutPath as_ordered(CutPath path, const OrderedPath& place);

// The same with the paths put into that order.
std::vector<CutPath> order_paths(std::vector<CutPath> paths,
                                 const Eigen::Vector2d& from,
                                 const OrderRules& rules = {},
                                 const geometry::Context& context = {});

// Way between the end of each path and the start of the next, beginning at `from`.
double travel_mm(const std::vector<CutPath>& paths, const Eigen::Vector2d& from);

}  // namespace leafcutter::fab
