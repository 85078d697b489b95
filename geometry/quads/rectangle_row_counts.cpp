// Rows of bands: the second half of RectangleCounter.

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/error.h"
#include "geometry/quads/edge_parity.h"
#include "geometry/quads/integer_program.h"
#include "geometry/quads/rectangle_counts.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Index;

// Two zeros may share a row if they are less than this apart, in rows.
constexpr double kSharedRow = 0.5;
constexpr int kMostRowChanges = 20;
constexpr double kFixedWeight = 1e3;
constexpr std::size_t kMostNodes = 200'000;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

}  // namespace

void RectangleCounter::set_rows(RectangleCounts& counts,
                                double size,
                                const Context& context) const {
    if (fixed_rows_) {
        set_fixed_rows(counts, size, context);
    } else {
        set_free_rows(counts, size);
    }
}

// As many as make the cells square, and even numbers round handles.
void RectangleCounter::set_free_rows(RectangleCounts& counts, double size) const {
    const auto zeros = static_cast<int>(network_.zeros.size());
    std::vector<double> ideal;
    std::vector<ParityEdge> edges;
    for (std::size_t b = 0; b < network_.bands.size(); ++b) {
        const FormBand& band = network_.bands[b];
        double cols = 0.0;
        double wished = 0.0;
        for (const int c : band.cylinders) {
            cols += counts.cols[at(c)];
            wished += width_[at(c)] / size;
        }
        ideal.push_back(scale_[b].total_mm() / size * cols / wished);
        // Each loop is a node of its own.
        const int loop = zeros + static_cast<int>(b);
        ParityEdge edge{band.lower < 0 ? loop : band.lower, band.upper < 0 ? loop : band.upper, {}};
        for (int parity = 0; parity < 2; ++parity) {
            edge.cost[at(parity)] =
                cols * ideal[b] *
                count_misfit(nearest_count(ideal[b], least_rows_[b], parity), ideal[b]);
        }
        if (mergeable_[b] != 0 && ideal[b] < kSharedRow) {
            edge.cost[0] = 0.0;
        }
        edges.push_back(edge);
    }
    const std::vector<int> parities =
        cheapest_parities(zeros + static_cast<int>(network_.bands.size()), edges);
    for (std::size_t b = 0; b < network_.bands.size(); ++b) {
        const bool shared = mergeable_[b] != 0 && ideal[b] < kSharedRow;
        const int parity = wish_.parity == Parity::Even ? parities[b] : kAnyParity;
        counts.rows.push_back(
            shared && parity != 1 ? 0 : nearest_count(ideal[b], least_rows_[b], parity));
    }
}

// So that the bands that a rectangle passes have its rows together.
void RectangleCounter::set_fixed_rows(RectangleCounts& counts,
                                      double size,
                                      const Context& context) const {
    const auto bands = static_cast<Index>(network_.bands.size());
    const auto rectangles = static_cast<Index>(network_.cylinders.size());
    IntegerConditions conditions;
    conditions.zero = Eigen::MatrixXi::Zero(0, bands);
    conditions.bounded = Eigen::MatrixXi::Identity(bands, bands);
    conditions.lower_bound = Eigen::VectorXi::Ones(bands);
    Eigen::MatrixXd forms = Eigen::MatrixXd::Zero(bands + rectangles, bands);
    Eigen::VectorXd targets = Eigen::VectorXd::Zero(bands + rectangles);
    for (Index b = 0; b < bands; ++b) {
        const double ideal = scale_[static_cast<std::size_t>(b)].total_mm() / size;
        forms(b, b) = 1.0 / std::sqrt(std::max(kSharedRow, ideal));
        targets[b] = ideal * forms(b, b);
        conditions.lower_bound[b] =
            mergeable_[static_cast<std::size_t>(b)] != 0 && ideal < kSharedRow
                ? 0
                : least_rows_[static_cast<std::size_t>(b)];
    }
    for (Index i = 0; i < rectangles; ++i) {
        const int c = network_.cylinders[static_cast<std::size_t>(i)];
        if (const std::optional<int>& rows = wish_.counts[at(c)].rows) {
            for (const int b : network_.band_at[at(c)]) {
                forms(bands + i, b) = kFixedWeight;
            }
            targets[bands + i] = kFixedWeight * *rows;
        }
    }
    const std::optional<IntegerSolution> found =
        IntegerProgram(forms, std::move(conditions)).solve(targets, kMostNodes, context);
    if (!found) {
        throw Error(ErrorKind::BadOption, "counts-do-not-fit",
                    "grid.rows: no numbers of rows fit together; leave some open");
    }
    counts.rows.assign(found->numbers.data(), found->numbers.data() + bands);
}

// Rows more or less where that comes closer to the wanted size.
void RectangleCounter::adjust_rows(Scored& found, double size, double cells) const {
    for (int change = 0; change < kMostRowChanges; ++change) {
        std::size_t best_band = network_.bands.size();
        int best_rows = 0;
        double least = found.score;
        for (std::size_t b = 0; b < network_.bands.size(); ++b) {
            // Bands between zeros may lie on a way round a handle.
            const bool inner = network_.bands[b].lower >= 0 && network_.bands[b].upper >= 0;
            const int step = inner && wish_.parity == Parity::Even ? 2 : 1;
            const int before = found.counts.rows[b];
            for (const int rows : {before - step, before + step}) {
                if (before == 0 || rows < least_rows_[b]) {
                    continue;
                }
                found.counts.rows[b] = rows;
                const double here = score(found.counts, size, cells);
                if (here < least) {
                    least = here;
                    best_band = b;
                    best_rows = rows;
                }
            }
            found.counts.rows[b] = before;
        }
        if (best_band == network_.bands.size()) {
            return;
        }
        found.counts.rows[best_band] = best_rows;
        found.score = least;
    }
}

}  // namespace leafcutter::geometry
