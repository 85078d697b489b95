// How far the quads of a grid lie off the surface, all or those of some strips, while levels still
// move.

#pragma once

#include <vector>

#include "geometry/closest_point.h"
#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/quads/chart_sampler.h"
#include "geometry/quads/grid.h"
#include "geometry/quads/spacing.h"

namespace leafcutter::geometry {

struct StripQuad {
    double distance_mm = 0.0;  // Largest, of some points of the bilinear patch.
    double weft_mm = 0.0;      // Mean of the two sides along the weft, and
    double warp_mm = 0.0;      // along the warp.
};

// Rows are the strips across Axis::F, columns those across Axis::G.
struct StripRange {
    Axis axis = Axis::F;
    int first = 0;
    int count = 0;
};

// By row and column.
struct GridDistances {
    std::vector<double> percent;  // Distance over the mean length of the two leaves, as the paper's
                                  // surface distance (quality.h).
    std::vector<double> row_mm;   // Lengths of the leaves along rows,
    std::vector<double> col_mm;   // and along columns.

    double largest() const;
    double mean() const;
};

class StripDistances {
public:
    // Refers to `sampler` and `surface`, which must outlive it. Thread-safe to ask.
    StripDistances(const ChartSampler& sampler, const ClosestPoint& surface, bool half_sag_offset)
        : sampler_(sampler), surface_(surface), half_sag_offset_(half_sag_offset) {}

    GridDistances measure(const ChartGrid& grid, const Context& context) const;

    // The quads of the strips, strip by strip. They depend on the levels of these strips and of one
    // more on either side, by the half-sag offset; on no others.
    std::vector<StripQuad> measure(const ChartGrid& grid, const StripRange& strips) const;

private:
    const ChartSampler& sampler_;
    const ClosestPoint& surface_;
    bool half_sag_offset_ = true;
};

}  // namespace leafcutter::geometry
