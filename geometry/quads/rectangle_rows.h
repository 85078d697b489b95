// The levels of rows in the rectangles of a one-form, alike from both sides of every side.

#pragma once

#include <vector>

#include "geometry/quads/critical_sides.h"
#include "geometry/quads/rectangle_counts.h"

namespace leafcutter::geometry {

// Rows lie at levels of f, but for those through several zeros: there f is bent a little, so that
// all of them come to lie at one level.
class RectangleRows {
public:
    // Keeps the network by reference. May give rows to bands of `counts` that have none, where
    // levels would not rise otherwise.
    RectangleRows(const SideNetwork& network,
                  const RectangleCounter& counter,
                  RectangleCounts& counts);

    // The levels of a cylinder's rows, from 0 to its height.
    std::vector<double> levels(int cylinder) const;
    // How many rows of a cylinder lie below a zero, by its place in the network; below the upper
    // loop for -1.
    int rows_below(int cylinder, int zero) const;
    // Where a zero is brought to.
    double level(int zero) const { return level_[static_cast<std::size_t>(zero)]; }
    // Where a point of a side at f is brought to, and back.
    double bent(const CriticalSide& side, double f) const;
    double unbent(const CriticalSide& side, double level) const;

private:
    void set_levels(const RectangleCounts& counts);
    bool levels_rise(const RectangleCounts& counts) const;

    const SideNetwork& network_;
    std::vector<double> level_;                     // Per zero.
    std::vector<std::vector<double>> band_levels_;  // Per band its rows + 1, or one.
};

}  // namespace leafcutter::geometry
