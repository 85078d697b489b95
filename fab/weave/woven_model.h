// The woven object with its thickness: every strip's middle surface, over and under.

#pragma once

#include <vector>

#include <Eigen/Core>

namespace leafcutter::fab {

// One strip's middle surface: rungs across it, some to a cell. Closed strips repeat the first one.
struct WovenStrip {
    int strip = 0;  // Into the list of strips.
    double thickness_mm = 0.0;
    std::vector<Eigen::Vector3d> left;
    std::vector<Eigen::Vector3d> right;
    std::vector<Eigen::Vector3d> normal;  // Unit, outward, per rung.
};

struct WovenModel {
    std::vector<WovenStrip> strips;  // In the order of the strips.
    // Between the surfaces of two strips that cross, the smallest: negative where they would have
    // to lie in each other.
    double smallest_gap_mm = 0.0;
    int overlaps = 0;  // Crossings where that is less than -1e-6 mm.
};

}  // namespace leafcutter::fab
