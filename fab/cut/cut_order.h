// The order in which paths are burnt, where closed ones start, and which way open ones run: as
// little travel between them as can be had quickly.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "fab/cut/cut_program.h"
#include "geometry/context.h"

namespace leafcutter::fab {

// Every path of `paths` exactly once; open ones may be reversed, closed ones may start at another
// of their points. All paths are of one operation. A closed path comes after every path that it
// encloses. The tour begins at `from` and ends anywhere. Deterministic.
std::vector<CutPath> order_paths(std::vector<CutPath> paths,
                                 const Eigen::Vector2d& from,
                                 const geometry::Context& context = {});

// Way between the end of each path and the start of the next, beginning at `from`.
double travel_mm(const std::vector<CutPath>& paths, const Eigen::Vector2d& from);

}  // namespace leafcutter::fab
