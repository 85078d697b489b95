#include "fab/material/totals.h"

#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

double piece_length_mm(const Piece& piece) {
    double length = 0.0;
    for (std::size_t i = 1; i < piece.left.size(); ++i) {
        const Eigen::Vector2d step =
            piece.left[i] + piece.right[i] - piece.left[i - 1] - piece.right[i - 1];
        length += step.norm() / 2.0;
    }
    return length;
}

FamilyTotals total_of(const JobResult& job, Family family) {
    FamilyTotals totals;
    for (const Strip& strip : job.strips) {
        if (strip.family == family) {
            ++totals.strips;
            totals.closed += strip.closed ? 1 : 0;
        }
    }
    for (const Piece& piece : job.pieces) {
        if (piece.family == family) {
            ++totals.pieces;
            totals.length_mm += piece_length_mm(piece);
            totals.area_mm2 += signed_area(piece.outline);
        }
    }
    totals.weight_g = totals.area_mm2 * 1e-6 * job.material_of(family).weight_g_per_m2;
    return totals;
}

}  // namespace leafcutter::fab
