// Strips of a woven model as closed solids.

#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fab/strips/strip.h"
#include "fab/weave/woven_model.h"

namespace leafcutter::fab {

// One strip with its thickness. Triangles are counter-clockwise seen from outside; every edge is
// shared by two of them. Lengths are mm.
struct Solid {
    std::string name;  // The strip's id.
    Family family = Family::Weft;
    std::vector<Eigen::Vector3d> vertices;
    std::vector<std::array<int, 3>> triangles;
};

// In the order of the strips.
std::vector<Solid> solids_of(std::span<const Strip> strips, const WovenModel& model);

}  // namespace leafcutter::fab
