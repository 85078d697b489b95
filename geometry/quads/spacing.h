// Levels of leaves that make strips evenly wide on the surface, not in the chart.
//
// A conformal map shrinks some parts, above all the tips of limbs, so that even levels of f or g
// give strips that differ in width by orders of magnitude. A LevelScale measures the mean width on
// the surface of the band between any two levels; even levels on it are even on the surface.

#pragma once

#include <cstddef>
#include <vector>

#include "geometry/foliation.h"

namespace leafcutter::geometry {

enum class Axis { G, F };

class LevelScale {
public:
    // Levels of f, or of the straight coordinate g - slant f. O(n log n) in the triangles.
    LevelScale(const Cylinder& chart, Axis axis, double slant);

    // The mean width of the whole chart across these levels, mm.
    double total_mm() const { return cumulated_.back(); }

    // The mean length of the leaves at its levels, mm: the chart's area is this times the width of
    // strips between them times their number.
    double mean_leaf_mm() const { return mean_leaf_; }
    // The same at even levels.
    double mean_even_leaf_mm() const { return mean_even_leaf_; }

    // count + 1 levels from 0 to the end, at equal mean distances. Exactly even ones where the
    // chart's scale is the same everywhere.
    std::vector<double> levels(int count) const;

private:
    double length_ = 1.0;
    std::vector<double> places_;     // Ascending, from 0 to length_.
    std::vector<double> cumulated_;  // Mean width between 0 and the place, mm.
    double mean_leaf_ = 0.0;
    double mean_even_leaf_ = 0.0;
};

}  // namespace leafcutter::geometry
