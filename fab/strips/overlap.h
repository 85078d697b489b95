// Exact tests on outlines. Outlines are snapped to a fine grid, so that every test is integer
// arithmetic without rounding.

#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "fab/strips/strip.h"

namespace leafcutter::fab {

// Steps of the grid: 1e-5 mm, far below anything a laser knows; up to 10 m stay exact.
constexpr double kGridPerMm = 1e5;

// Rounds to the grid and drops points that fall together; empty if fewer than 3 remain.
Ring snapped(const Ring& ring);

// True if the ring, already snapped, runs counter-clockwise and no two of its edges share a point
// but neighbours their common corner. Expected O(n).
bool is_simple(const Ring& ring);

// True if the ring grown by half of `gap_mm` on all sides still has no hole and stays one: nowhere
// do distant parts of it come closer than that, so that they are cut apart.
bool keeps_gap(const Ring& ring, double gap_mm);

// Answers whether a line stays strictly inside a ring.
class RingInterior {
public:
    // `ring` is snapped and simple and must outlive this object.
    explicit RingInterior(const Ring& ring);

    // True if no point of the polyline touches or leaves the ring, judged on the grid.
    bool contains(const Polyline& line) const;

private:
    using Cell = std::pair<int, int>;
    struct CellHash {
        std::size_t operator()(const Cell& cell) const;
    };

    bool inside(const Eigen::Vector2d& point) const;

    const Ring& ring_;
    double cell_mm_ = 1.0;
    std::unordered_map<Cell, std::vector<int>, CellHash> edges_;  // Edge i: from point i.
};

}  // namespace leafcutter::fab
