#include "geometry/quads/rectangle_counts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "geometry/disjoint_sets.h"
#include "geometry/error.h"
#include "geometry/quads/band_chart.h"
#include "geometry/quads/edge_parity.h"

namespace leafcutter::geometry {
namespace {

// Sizes tried: this far to both sides of the wanted number of cells, in so many steps.
constexpr double kScan = 0.15;
constexpr int kScanSteps = 24;
// Strips as wide as asked for in the mean is more than any other wish: within the tolerance of the
// number of cells all are alike.
constexpr double kCountTolerance = 0.015;
constexpr double kCountWeight = 1e3;
constexpr double kForbidden = 1e9;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

double square(double x) {
    return x * x;
}

}  // namespace

int nearest_count(double ideal, int least, int parity) {
    int best = 0;
    const int low = std::max(least, static_cast<int>(ideal) - 1);
    for (int count = low; count <= low + 4; ++count) {
        if (parity != kAnyParity && count % 2 != parity) {
            continue;
        }
        if (best == 0 || std::abs(std::log(count / ideal)) < std::abs(std::log(best / ideal))) {
            best = count;
        }
    }
    return best;
}

double count_misfit(int count, double ideal) {
    return square(std::log(count / ideal));
}

RectangleCounter::RectangleCounter(const Foliation& foliation,
                                   const SideNetwork& network,
                                   RectangleWish wish)
    : foliation_(foliation), network_(network), wish_(std::move(wish)) {
    width_.assign(foliation.cylinders.size(), 0.0);
    for (const int c : network.cylinders) {
        width_[at(c)] = LevelScale(foliation.cylinders[at(c)], Axis::G, 0.0).total_mm();
    }
    for (const FormBand& band : network.bands) {
        const double low = band.lower < 0 ? 0.0 : network.zeros[at(band.lower)].f;
        const double height = foliation.cylinders[at(band.cylinders.front())].height;
        const double high = band.upper < 0 ? height : network.zeros[at(band.upper)].f;
        low_.push_back(low);
        high_.push_back(high);
        scale_.emplace_back(chart_of_band(foliation, band, low, high), Axis::F, 0.0);
    }
    find_mergeable();
    set_least_rows();
    set_wanted();
}

std::vector<double> RectangleCounter::band_levels(int band, int rows) const {
    std::vector<double> levels = scale_[at(band)].levels(rows);
    for (double& level : levels) {
        level += low_[at(band)];
    }
    levels.back() = high_[at(band)];
    return levels;
}

// Two zeros on one flank can't share a row.
void RectangleCounter::find_mergeable() {
    std::set<std::pair<int, int>> linked;
    for (const int c : network_.cylinders) {
        for (const Flank& flank : network_.flanks[at(c)]) {
            std::vector<int> zeros;
            for (std::size_t u = 1; u < flank.uses.size(); ++u) {
                zeros.push_back(
                    network_.zero_of(network_.sides[at(flank.uses[u].side)].points.front()));
            }
            for (const int a : zeros) {
                for (const int b : zeros) {
                    linked.emplace(a, b);
                }
            }
        }
    }
    for (const FormBand& band : network_.bands) {
        const bool inner = band.lower >= 0 && band.upper >= 0;
        mergeable_.push_back(inner && linked.count({band.lower, band.upper}) == 0 ? 1 : 0);
    }
}

// Two sides of one row each, between the same zeros, would be one edge.
void RectangleCounter::set_least_rows() {
    least_rows_.assign(network_.bands.size(), 1);
    std::map<std::pair<int, int>, int> sides;
    for (const CriticalSide& side : network_.sides) {
        ++sides[{side.points.front(), side.points.back()}];
    }
    for (const CriticalSide& side : network_.sides) {
        const int low = network_.zero_of(side.points.front());
        const int high = network_.zero_of(side.points.back());
        if (low < 0 || high < 0 || sides.at({side.points.front(), side.points.back()}) < 2) {
            continue;
        }
        const std::vector<int>& bands = network_.band_at[at(std::max(side.left, side.right))];
        if (bands[at(low + 1)] == bands[at(high)]) {
            least_rows_[at(bands[at(high)])] = 2;
        }
    }
}

void RectangleCounter::set_wanted() {
    wanted_ = wish_.cells;
    double sum = 0.0;
    bool all = true;
    for (const int c : network_.cylinders) {
        const RowsCols& counts = wish_.counts[at(c)];
        double height = 0.0;
        for (const int b :
             std::set<int>(network_.band_at[at(c)].begin(), network_.band_at[at(c)].end())) {
            height += scale_[at(b)].total_mm();
        }
        const double aspect = height / width_[at(c)];
        fixed_rows_ = fixed_rows_ || counts.rows;
        fixed_ = fixed_ || counts.rows || counts.cols;
        all = all && (counts.rows || counts.cols);
        if (counts.rows && counts.cols) {
            sum += static_cast<double>(*counts.rows) * *counts.cols;
        } else if (counts.rows) {
            sum += square(*counts.rows) / aspect;
        } else if (counts.cols) {
            sum += square(*counts.cols) * aspect;
        }
    }
    wanted_ = all && fixed_ ? sum : wanted_;
}

RectangleCounts RectangleCounter::choose(double cells, const Context& context) const {
    double unit = 0.0;
    for (std::size_t b = 0; b < scale_.size(); ++b) {
        for (const int c : network_.bands[b].cylinders) {
            unit += scale_[b].total_mm() * width_[at(c)];
        }
    }
    std::optional<Scored> best;
    for (int i = -kScanSteps; i <= kScanSteps; ++i) {
        context.check();
        const double size = std::sqrt(unit / (cells * std::exp(kScan * i / kScanSteps)));
        Scored found;
        set_cols(found.counts, size);
        set_rows(found.counts, size, context);
        found.score = score(found.counts, size, cells);
        if (!fixed_rows_) {
            adjust_rows(found, size, cells);
        }
        if (!best || found.score < best->score) {
            best = std::move(found);
        }
    }
    best->counts.cells = cells_of(best->counts);
    check_fixed(best->counts);
    return std::move(best->counts);
}

double RectangleCounter::score(const RectangleCounts& counts, double size, double cells) const {
    const double off = std::abs(cells_of(counts) / cells - 1.0) - kCountTolerance;
    return strain(counts, size) + (fixed_ ? 0.0 : kCountWeight * square(std::max(0.0, off)));
}

// Colours alternate if the columns between the flanks of a rectangle are an odd number just where
// the flanks' zeros are labelled differently; zeros that are joined along sides are labelled alike.
void RectangleCounter::set_cols(RectangleCounts& counts, double size) const {
    counts.cols.assign(network_.flanks.size(), 0);
    const bool even = wish_.parity == Parity::Even;
    DisjointSets joined(network_.zeros.size());
    for (const CriticalSide& side : network_.sides) {
        const int low = network_.zero_of(side.points.front());
        const int high = network_.zero_of(side.points.back());
        if (low >= 0 && high >= 0) {
            joined.unite(static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(high));
        }
    }
    const auto label_of = [&](const Flank& flank) {
        const CriticalSide& side = network_.sides[at(flank.uses.back().side)];
        const int zero = network_.zero_of(side.points.front());
        return static_cast<int>(joined.find(static_cast<std::uint32_t>(zero)));
    };
    const auto count_of = [&](int c, int parity) {
        const double ideal = width_[at(c)] / size;
        const std::optional<int>& fixed = wish_.counts[at(c)].cols;
        return fixed ? *fixed : nearest_count(ideal, 1, parity);
    };
    std::vector<ParityEdge> edges;
    for (const int c : network_.cylinders) {
        ParityEdge edge{label_of(network_.flanks[at(c)][SideNetwork::Left]),
                        label_of(network_.flanks[at(c)][SideNetwork::Right]),
                        {}};
        for (int parity = 0; parity < 2; ++parity) {
            const int count = count_of(c, parity);
            edge.cost[at(parity)] =
                count % 2 != parity
                    ? kForbidden
                    : square(width_[at(c)] / size) * count_misfit(count, width_[at(c)] / size);
        }
        edges.push_back(edge);
    }
    std::vector<int> parities;
    if (even) {
        parities = cheapest_parities(static_cast<int>(network_.zeros.size()), edges);
    }
    for (std::size_t i = 0; i < network_.cylinders.size(); ++i) {
        const int c = network_.cylinders[i];
        counts.cols[at(c)] = count_of(c, even ? parities[i] : kAnyParity);
        const auto excess = [&](int k) { return counts.cols[at(k)] * size / width_[at(k)]; };
        if (counts.tightest < 0 || excess(c) > excess(counts.tightest)) {
            counts.tightest = c;
        }
    }
    widen_rings(counts, size);
}

// Fewer cells round a ring would double its edges, or let no colours alternate.
void RectangleCounter::widen_rings(RectangleCounts& counts, double size) const {
    const bool even = wish_.parity == Parity::Even;
    for (const FormBand& band : network_.bands) {
        for (;;) {
            int around = 0;
            int best = -1;
            for (const int c : band.cylinders) {
                around += counts.cols[at(c)];
                const auto excess = [&](int k) {
                    return counts.cols[at(k)] * size / width_[at(k)];
                };
                if (!wish_.counts[at(c)].cols && (best < 0 || excess(c) < excess(best))) {
                    best = c;
                }
            }
            if (!band.closed || around >= (even ? 4 : 3) || best < 0) {
                break;
            }
            counts.cols[at(best)] += even ? 2 : 1;
        }
    }
}

double RectangleCounter::cells_of(const RectangleCounts& counts) const {
    double cells = 0.0;
    for (std::size_t b = 0; b < network_.bands.size(); ++b) {
        for (const int c : network_.bands[b].cylinders) {
            cells += static_cast<double>(counts.rows[b]) * counts.cols[at(c)];
        }
    }
    return cells;
}

// How far from square cells are, in the mean.
double RectangleCounter::strain(const RectangleCounts& counts, double size) const {
    double sum = 0.0;
    double all = 0.0;
    for (std::size_t b = 0; b < network_.bands.size(); ++b) {
        const double height = scale_[b].total_mm() / size;
        for (const int c : network_.bands[b].cylinders) {
            const double width = width_[at(c)] / size;
            all += width * height;
            if (counts.rows[b] > 0) {
                sum += width * height *
                       square(std::log(counts.rows[b] / height * width / counts.cols[at(c)]));
            } else {
                sum += square(height);
            }
        }
    }
    return sum / all;
}

void RectangleCounter::check_fixed(const RectangleCounts& counts) const {
    for (const int c : network_.cylinders) {
        const RowsCols& wished = wish_.counts[at(c)];
        int rows = 0;
        for (const int b :
             std::set<int>(network_.band_at[at(c)].begin(), network_.band_at[at(c)].end())) {
            rows += counts.rows[at(b)];
        }
        if (wished.rows && *wished.rows != rows) {
            throw Error(ErrorKind::BadOption, "rows-do-not-fit",
                        fmt::format("{}.rows: {} rows don't fit those of neighbours; cylinder {} "
                                    "could have {}",
                                    wish_.paths[at(c)], *wished.rows, c, rows));
        }
    }
    if (wish_.parity == Parity::Any) {
        return;
    }
    for (const FormBand& band : network_.bands) {
        int around = 0;
        for (const int c : band.cylinders) {
            around += counts.cols[at(c)];
        }
        if (band.closed && around % 2 != 0) {
            throw Error(ErrorKind::BadOption, "odd-cols",
                        fmt::format("{}.cols: {} columns close a ring, so colours can't alternate; "
                                    "change one, or use grid.parity any",
                                    wish_.paths[at(band.cylinders.front())], around));
        }
    }
}

}  // namespace leafcutter::geometry
