// JunctionCounter: rows.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "geometry/disjoint_sets.h"
#include "geometry/quads/junction_counts.h"
#include "geometry/quads/junction_parity.h"

namespace leafcutter::geometry {
namespace {

// Of a row: what is thinner gets none.
constexpr double kThinnest = 0.25;
// Strips as wide as asked for in the mean, to 2 %, is more than any other wish.
constexpr double kCountTolerance = 0.015;
constexpr double kCountWeight = 1e3;
constexpr double kForbidden = 1e9;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

double square(double x) {
    return x * x;
}

// Fewer rows than these would give two edges the same two vertices. `node_of` names the nodes as
// they are when thin cylinders are left out.
std::vector<int> least_rows(const ArcNetwork& network,
                            const std::vector<char>& thin,
                            DisjointSets& nodes) {
    std::vector<int> least(network.ends.size(), 1);
    const auto joins = [&](int c) {
        std::array<int, 2> both = network.node[at(c)];
        for (int& node : both) {
            node = node < 0 ? -1 : static_cast<int>(nodes.find(static_cast<std::uint32_t>(node)));
        }
        std::sort(both.begin(), both.end());
        return both;
    };
    for (const int c : network.cylinders) {
        const auto [lower, upper] = joins(c);
        if (lower < 0 || thin[at(c)] != 0) {
            continue;
        }
        const bool parallel =
            std::any_of(network.cylinders.begin(), network.cylinders.end(), [&](int other) {
                return other != c && thin[at(other)] == 0 && joins(other) == joins(c);
            });
        const bool twice =
            network.ends[at(c)][0].uses.size() >= 4 && network.ends[at(c)][1].uses.size() >= 4;
        least[at(c)] = lower == upper ? 3 : parallel || twice ? 2 : 1;
    }
    return least;
}

}  // namespace

double JunctionCounter::ideal_rows(const JunctionCounts& counts, int cylinder) const {
    return aspect_[at(cylinder)] * counts.cols[at(cylinder)];
}

// Cylinders too thin for a row of cells: their ends are joined instead, but never all round a cycle
// of them, where a vertex would meet itself.
void JunctionCounter::leave_out_thin(JunctionCounts& counts) const {
    std::vector<char> thin(network_.ends.size(), 0);
    std::vector<std::pair<double, int>> candidates;
    for (const int c : network_.cylinders) {
        const double ideal = ideal_rows(counts, c);
        const bool joined = !network_.is_open(c, 0) && !network_.is_open(c, 1);
        if (joined && !wish_.counts[at(c)].rows && ideal < kThinnest) {
            candidates.emplace_back(ideal, c);
        }
    }
    std::sort(candidates.begin(), candidates.end());
    DisjointSets nodes(at(network_.nodes));
    for (const auto& [ideal, c] : candidates) {
        const auto [lower, upper] = network_.node[at(c)];
        thin[at(c)] =
            nodes.unite(static_cast<std::uint32_t>(lower), static_cast<std::uint32_t>(upper)) ? 1
                                                                                              : 0;
    }
    counts.least_rows = least_rows(network_, thin, nodes);
    for (const int c : network_.cylinders) {
        if (thin[at(c)] != 0) {
            counts.least_rows[at(c)] = 0;
        }
    }
}

int JunctionCounter::nearest_rows(const JunctionCounts& counts,
                                  int cylinder,
                                  std::optional<int> parity) const {
    if (wish_.counts[at(cylinder)].rows) {
        return *wish_.counts[at(cylinder)].rows;
    }
    const int least = counts.least_rows[at(cylinder)];
    if (least == 0) {
        return parity.value_or(0);
    }
    const double ideal = ideal_rows(counts, cylinder);
    int best = 0;
    const int low = std::max(least, static_cast<int>(ideal) - 1);
    for (int rows = low; rows <= low + 4; ++rows) {
        if (parity && rows % 2 != *parity) {
            continue;
        }
        if (best == 0 || std::abs(std::log(rows / ideal)) < std::abs(std::log(best / ideal))) {
            best = rows;
        }
    }
    return best;
}

// The parity of rows that lets colours alternate everywhere, where that is asked for.
JunctionCounter::Parities JunctionCounter::row_parities(const JunctionCounts& counts) const {
    if (!has_colours()) {
        return Parities(network_.ends.size());
    }
    std::vector<ParityCost> costs(network_.ends.size(), {0.0, 0.0});
    for (const int c : network_.cylinders) {
        for (int parity = 0; parity < 2; ++parity) {
            const int rows = nearest_rows(counts, c, parity);
            costs[at(c)][at(parity)] =
                rows % 2 != parity ? kForbidden : stretch_cost(counts, c, rows);
        }
    }
    return choose_row_parities(network_, colour_ends(network_, counts.arc_cells), counts.twist,
                               costs);
}

// Over the cells of a cylinder: the squared logarithm of their height over their width.
double JunctionCounter::stretch_cost(const JunctionCounts& counts, int cylinder, int rows) const {
    const double ideal = ideal_rows(counts, cylinder);
    return rows == 0 ? 0.0 : counts.cols[at(cylinder)] * ideal * square(std::log(rows / ideal));
}

void JunctionCounter::set_rows(JunctionCounts& counts, double cells) const {
    leave_out_thin(counts);
    counts.rows.assign(network_.ends.size(), 0);
    const Parities parities = row_parities(counts);
    for (const int c : network_.cylinders) {
        counts.rows[at(c)] = nearest_rows(counts, c, parities[at(c)]);
        counts.misfits += parities[at(c)] && counts.rows[at(c)] % 2 != *parities[at(c)] ? 1 : 0;
    }
    while (change_rows(counts, parities, cells)) {
    }
    counts.cells = 0;
    double most = 0.0;
    for (const int c : network_.cylinders) {
        const int own = counts.rows[at(c)] * counts.cols[at(c)];
        counts.cells += own;
        const double share =
            cells * square(foliation_.cylinders[at(c)].width) * aspect_[at(c)] / unit_area_;
        if (own / share > most) {
            most = own / share;
            counts.tightest = c;
        }
    }
}

// A row more or less, or two, where that strains least; false if none strains less than before.
bool JunctionCounter::change_rows(JunctionCounts& counts,
                                  const Parities& parities,
                                  double cells) const {
    double least = strain(counts, cells);
    int best_cylinder = -1;
    int best_rows = 0;
    for (const int c : network_.cylinders) {
        const int step = parities[at(c)] ? 2 : 1;
        const int before = counts.rows[at(c)];
        if (wish_.counts[at(c)].rows || before == 0) {
            continue;
        }
        for (const int rows : {before - step, before + step}) {
            if (rows < std::max(counts.least_rows[at(c)], 1)) {
                continue;
            }
            counts.rows[at(c)] = rows;
            const double found = strain(counts, cells);
            if (found < least) {
                least = found;
                best_cylinder = c;
                best_rows = rows;
            }
        }
        counts.rows[at(c)] = before;
    }
    if (best_cylinder >= 0) {
        counts.rows[at(best_cylinder)] = best_rows;
    }
    return best_cylinder >= 0;
}

// The mean square of the cells' stretch and slant, and what the number of cells is off.
double JunctionCounter::strain(const JunctionCounts& counts, double cells) const {
    double sum = 0.0;
    double area = 0.0;
    double all = 0.0;
    for (const int c : network_.cylinders) {
        const double own = static_cast<double>(counts.rows[at(c)]) * counts.cols[at(c)];
        const double ideal = ideal_rows(counts, c);
        if (counts.rows[at(c)] > 0) {
            sum += stretch_cost(counts, c, counts.rows[at(c)]) +
                   counts.cols[at(c)] * ideal * square(counts.slip[at(c)] / ideal);
        }
        area += counts.cols[at(c)] * ideal;
        all += own;
    }
    const double off = std::abs(std::log(all / cells));
    const double beyond = std::max(0.0, off - kCountTolerance);
    return sum / area + (fixed_ ? 0.0 : square(off) + kCountWeight * square(beyond));
}

}  // namespace leafcutter::geometry
