// Which singular points come nearest to places where ones are wanted.

#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

// Per row its column, no two alike, so that the costs add up to least. No more rows than columns.
// Hungarian method, O(rows^2 x columns).
std::vector<int> assign_columns(const Eigen::MatrixXd& cost);

// Per wanted vertex of a connected mesh another one of `points`, which lie on it or nearly, such
// that the squares of distances along the surface add up to least. `singularity` counts in
// `points`. Throws Error(BadOption, "too-many-near") if there are fewer points than wanted ones.
std::vector<ReachedPoint> reached_points(const TriangleMesh& mesh,
                                         std::span<const int> wanted,
                                         std::span<const Eigen::Vector3d> points,
                                         const Context& context);

}  // namespace leafcutter::geometry
