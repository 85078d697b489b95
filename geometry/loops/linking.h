// Linking numbers of the closed lines on a surface in space.

#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace leafcutter::geometry {

using IntegerMatrix = Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic>;

// Linking number of two closed polylines that don't meet: the signed crossings, seen along some
// direction, of the first over the second. Empty if crossings the other way round add up
// differently, which they don't but for rounding.
std::optional<int> linking_number(std::span<const Eigen::Vector3d> a,
                                  std::span<const Eigen::Vector3d> b);

// Per vertex of a closed surface, faces outward: a place just outside.
std::vector<Eigen::Vector3d> pushed_out(std::span<const std::array<int, 3>> triangles,
                                        std::span<const Eigen::Vector3d> positions);

// Entry (i, j): linking number of cycle i with cycle j pushed outward.
std::optional<IntegerMatrix> linking_matrix(std::span<const std::vector<int>> cycles,
                                            std::span<const Eigen::Vector3d> positions,
                                            std::span<const Eigen::Vector3d> outside);

}  // namespace leafcutter::geometry
