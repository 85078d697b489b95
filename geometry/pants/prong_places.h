// Where the three-prong points of a map lie, without slicing.

#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "geometry/pants/hierarchy.h"
#include "geometry/pants/tree_word.h"

namespace leafcutter::geometry {

struct ProngPlace {
    std::array<int, 3> corners{};  // Of the level's flipped triangle that it lies in.
    Eigen::Vector3d position;
};

// A triangle of the level's flipped surface has one where its corners lie on three legs of a node
// of the tree.
std::vector<ProngPlace> prong_places(const Hierarchy::Level& level, const GraphMap& map);

}  // namespace leafcutter::geometry
