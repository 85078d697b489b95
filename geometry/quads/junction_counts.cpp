#include "geometry/quads/junction_counts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/quads/junction_parity.h"
#include "geometry/quads/spacing.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Index;

// Of the search for whole numbers: at every size tried, and at the best few of them.
constexpr std::size_t kQuickNodes = 5'000;
constexpr std::size_t kMostNodes = 100'000;
constexpr std::size_t kThorough = 3;
// Sizes tried: this far to both sides of the wanted number of cells, in so many steps.
constexpr double kScan = 0.1;
constexpr int kScanSteps = 16;
// Arcs much shorter than a cell count as so many cells in the costs, or they would rule.
constexpr double kShortest = 0.3;
// Of fixed columns against lengths of arcs.
constexpr double kFixedWeight = 1e3;
constexpr double kForbidden = 1e9;
// What an arc that is a cell too long or short slants near it, against a cylinder as long as it is
// wide that is twisted by a cell.
constexpr double kArcSlant = 0.25;
// Cylinders flatter than this have too little area to rule the rest by their twist.
constexpr double kFlattest = 0.005;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

double square(double x) {
    return x * x;
}

// The mean of columns - scale g along an end, over g.
double mean_offset(const CylinderEnd& end, const std::vector<double>& columns) {
    const double period = end.g.back() - end.g.front();
    const double scale = columns.back() / period;
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < end.g.size(); ++i) {
        const double here = columns[i] - scale * end.g[i];
        const double next = columns[i + 1] - scale * end.g[i + 1];
        sum += 0.5 * (here + next) * (end.g[i + 1] - end.g[i]);
    }
    return sum / period;
}

// How many cells a leaf of F* is off at the upper end, for each cell on each arc: the twist that a
// cylinder wants is a sum of these.
Eigen::RowVectorXd twist_form(const std::array<CylinderEnd, 2>& ends, std::size_t arcs) {
    Eigen::RowVectorXd form = Eigen::RowVectorXd::Zero(static_cast<Index>(arcs));
    for (std::size_t a = 0; a < arcs; ++a) {
        std::vector<int> one(arcs, 0);
        one[a] = 1;
        for (std::size_t side = 0; side < 2; ++side) {
            const auto& uses = ends[side].uses;
            if (std::any_of(uses.begin(), uses.end(),
                            [&](const ArcUse& use) { return at(use.arc) == a; })) {
                const double offset = mean_offset(ends[side], column_positions(ends[side], one));
                form[static_cast<Index>(a)] += side == 0 ? offset : -offset;
            }
        }
    }
    return form;
}

double arc_weight(double cells) {
    return std::sqrt(std::max(kArcSlant, 1.0 / std::max(kShortest, cells)));
}

int sum_along(const CylinderEnd& end, const std::vector<int>& arc_cells) {
    return std::accumulate(end.uses.begin(), end.uses.end(), 0, [&](int sum, const ArcUse& use) {
        return sum + arc_cells[at(use.arc)];
    });
}

}  // namespace

std::vector<double> column_positions(const CylinderEnd& end, const std::vector<int>& arc_cells) {
    std::vector<double> positions;
    positions.reserve(end.g.size());
    int offset = 0;
    for (std::size_t u = 0; u < end.uses.size(); ++u) {
        const int cells = arc_cells[at(end.uses[u].arc)];
        const std::size_t last =
            u + 1 < end.uses.size() ? end.uses[u + 1].first : end.vertices.size();
        for (std::size_t i = end.uses[u].first; i < last; ++i) {
            positions.push_back(offset + cells * end.share[i]);
        }
        offset += cells;
    }
    positions.push_back(offset);
    return positions;
}

JunctionCounter::JunctionCounter(const Foliation& foliation,
                                 const ArcNetwork& network,
                                 JunctionWish wish)
    : foliation_(foliation),
      network_(network),
      wish_(std::move(wish)),
      aspect_(foliation.cylinders.size(), 1.0) {
    double area = 0.0;
    double leaves = 0.0;  // Length of a leaf of F* in each column of unit width.
    for (const int c : network.cylinders) {
        const Cylinder& chart = foliation.cylinders[at(c)];
        const double height = LevelScale(chart, Axis::G, 0.0).mean_even_leaf_mm();
        aspect_[at(c)] = height / LevelScale(chart, Axis::F, 0.0).mean_leaf_mm();
        unit_area_ += square(chart.width) * aspect_[at(c)];
        area += surface_area(chart.mesh);
        leaves += chart.width * height;
    }
    // Strips are as wide as wished on average over their length.
    wish_.cells *= unit_area_ * area / square(leaves);
    set_wanted();
    program_.emplace(make_program());
}

void JunctionCounter::set_wanted() {
    wanted_ = wish_.cells;
    double sum = 0.0;
    bool all = true;
    for (const int c : network_.cylinders) {
        const RowsCols& counts = wish_.counts[at(c)];
        fixed_ = fixed_ || counts.rows || counts.cols;
        all = all && (counts.rows || counts.cols);
        if (counts.rows && counts.cols) {
            sum += static_cast<double>(*counts.rows) * *counts.cols;
        } else if (counts.rows) {
            sum += square(*counts.rows) / aspect_[at(c)];
        } else if (counts.cols) {
            sum += square(*counts.cols) * aspect_[at(c)];
        }
    }
    wanted_ = all && fixed_ ? sum : wanted_;
}

// Numbers: cells of each arc, then the periods round each cylinder if those are to be whole, then
// the twist of each. Costs are about the squared slants of cells, summed up.
IntegerProgram JunctionCounter::make_program() const {
    const auto arcs = static_cast<Index>(network_.arcs.size());
    const auto rings = static_cast<Index>(network_.cylinders.size());
    const bool even = wish_.parity == Parity::Even;
    const Index twists = arcs + (even ? rings : 0);
    const Index numbers = twists + rings;
    const auto around = [&](int c, std::size_t end) {
        Eigen::RowVectorXi sum = Eigen::RowVectorXi::Zero(numbers);
        for (const ArcUse& use : network_.ends[at(c)][end].uses) {
            sum[use.arc] += 1;
        }
        return sum;
    };
    std::vector<Eigen::RowVectorXi> zero;
    IntegerConditions conditions;
    conditions.bounded = Eigen::MatrixXi::Zero(arcs + rings, numbers);
    conditions.bounded.topLeftCorner(arcs, arcs).setIdentity();
    conditions.lower_bound = Eigen::VectorXi::Ones(arcs + rings);
    Eigen::MatrixXd forms = Eigen::MatrixXd::Zero(arcs + 2 * rings, numbers);
    const Eigen::VectorXd ideal = lengths(wanted_);
    for (Index a = 0; a < arcs; ++a) {
        forms(a, a) = arc_weight(ideal[a]);
    }
    for (Index r = 0; r < rings; ++r) {
        const int c = network_.cylinders[static_cast<std::size_t>(r)];
        const std::size_t known = network_.is_open(c, 0) ? 1 : 0;
        const Eigen::RowVectorXi circumference = around(c, known);
        const Index twist = arcs + rings + r;
        forms(twist, twists + r) = -1.0;
        if (known == 0 && !network_.is_open(c, 1)) {
            zero.emplace_back(circumference - around(c, 1));
            forms.row(twist).head(arcs) = twist_form(network_.ends[at(c)], network_.arcs.size());
            forms.row(twist) /= std::sqrt(std::max(kFlattest, aspect_[at(c)]));
        }
        if (even) {
            zero.push_back(circumference);
            zero.back()[arcs + r] = -wish_.period;
        }
        conditions.bounded.row(arcs + r) = circumference;
        conditions.lower_bound[arcs + r] = has_colours() ? 4 : 3;
        if (wish_.counts[at(c)].cols) {
            forms.row(arcs + r) = kFixedWeight * circumference.cast<double>();
        }
    }
    conditions.zero = Eigen::MatrixXi::Zero(static_cast<Index>(zero.size()), numbers);
    for (std::size_t i = 0; i < zero.size(); ++i) {
        conditions.zero.row(static_cast<Index>(i)) = zero[i];
    }
    return {forms, std::move(conditions)};
}

// Of arcs, in cells, where so many cells cover the surface.
Eigen::VectorXd JunctionCounter::lengths(double cells) const {
    const double size = std::sqrt(unit_area_ / cells);
    Eigen::VectorXd lengths(static_cast<Index>(network_.arcs.size()));
    for (std::size_t a = 0; a < network_.arcs.size(); ++a) {
        lengths[static_cast<Index>(a)] = network_.arcs[a].length / size;
    }
    return lengths;
}

JunctionCounts JunctionCounter::choose(double cells, const Context& context) const {
    std::optional<Scored> best;
    std::vector<std::pair<double, double>> unproven;  // Score and scale.
    const auto consider = [&](double scale, std::size_t most_nodes) {
        context.check();
        std::optional<Scored> found = try_size(cells, scale, most_nodes, context);
        if (found && !found->counts.proven && most_nodes == kQuickNodes) {
            unproven.emplace_back(found->score, scale);
        }
        if (found && (!best || found->score < best->score)) {
            best = std::move(found);
        }
    };
    for (int i = -kScanSteps; i <= kScanSteps; ++i) {
        consider(std::exp(kScan * i / kScanSteps), kQuickNodes);
    }
    std::sort(unproven.begin(), unproven.end());
    unproven.resize(std::min(unproven.size(), kThorough));
    for (const auto& [score, scale] : unproven) {
        consider(scale, kMostNodes);
    }
    if (!best) {
        throw Error(ErrorKind::BadOption, "counts-do-not-fit",
                    "grid.junctions: no numbers of columns fit together at the junctions; leave "
                    "some of grid.cols open, or use independent junctions");
    }
    check_fixed(best->counts);
    best->counts.distortion = best->score;
    return std::move(best->counts);
}

std::optional<JunctionCounter::Scored> JunctionCounter::try_size(double cells,
                                                                 double scale,
                                                                 std::size_t most_nodes,
                                                                 const Context& context) const {
    const auto arcs = static_cast<Index>(network_.arcs.size());
    const Eigen::VectorXd ideal = lengths(wanted_);
    const Eigen::VectorXd wished = lengths(cells * scale);
    Eigen::VectorXd targets =
        Eigen::VectorXd::Zero(arcs + 2 * static_cast<Index>(network_.cylinders.size()));
    for (Index a = 0; a < arcs; ++a) {
        targets[a] = wished[a] * arc_weight(ideal[a]);
    }
    for (std::size_t r = 0; r < network_.cylinders.size(); ++r) {
        const RowsCols& counts = wish_.counts[at(network_.cylinders[r])];
        targets[arcs + static_cast<Index>(r)] = counts.cols ? kFixedWeight * *counts.cols : 0.0;
    }
    const std::optional<IntegerSolution> solution = program_->solve(targets, most_nodes, context);
    if (!solution) {
        return std::nullopt;
    }
    Scored found;
    JunctionCounts& counts = found.counts;
    counts.proven = solution->proven;
    counts.arc_cells.assign(solution->numbers.data(), solution->numbers.data() + arcs);
    set_twists(counts);
    set_rows(counts, cells);
    found.score = strain(counts, cells) + kForbidden * counts.misfits;
    for (Index a = 0; a < arcs; ++a) {
        const double off = counts.arc_cells[static_cast<std::size_t>(a)] - wished[a];
        found.score += square(off * arc_weight(wished[a])) / cells;
    }
    return found;
}

void JunctionCounter::set_twists(JunctionCounts& counts) const {
    const std::size_t size = network_.ends.size();
    counts.cols.assign(size, 0);
    counts.twist.assign(size, 0);
    counts.slip.assign(size, 0.0);
    for (const int c : network_.cylinders) {
        const auto& ends = network_.ends[at(c)];
        const bool open = network_.is_open(c, 0) || network_.is_open(c, 1);
        counts.cols[at(c)] = sum_along(ends[network_.is_open(c, 0) ? 1 : 0], counts.arc_cells);
        if (open) {
            continue;
        }
        const double wished = mean_offset(ends[0], column_positions(ends[0], counts.arc_cells)) -
                              mean_offset(ends[1], column_positions(ends[1], counts.arc_cells));
        counts.twist[at(c)] = static_cast<int>(std::lround(wished));
        counts.slip[at(c)] = counts.twist[at(c)] - wished;
    }
}

void JunctionCounter::check_fixed(const JunctionCounts& counts) const {
    for (const int c : network_.cylinders) {
        const RowsCols& wish = wish_.counts[at(c)];
        const std::string& path = wish_.paths[at(c)];
        if (wish.cols && *wish.cols != counts.cols[at(c)]) {
            throw Error(ErrorKind::BadOption, "bad-cols",
                        fmt::format("{}.cols: {} columns don't go on from cylinder {} into its "
                                    "neighbours; {} do, or use independent junctions",
                                    path, *wish.cols, c, counts.cols[at(c)]));
        }
        if (wish.rows && *wish.rows < counts.least_rows[at(c)]) {
            throw Error(ErrorKind::BadOption, "too-few-rows",
                        fmt::format("{}.rows: {} can't carry cylinder {}; use at least {}", path,
                                    *wish.rows, c, counts.least_rows[at(c)]));
        }
    }
    if (!has_colours() || !fixed_) {
        return;
    }
    // With rows fixed the colours may not come out even.
    std::vector<ParityCost> costs(network_.ends.size(), {0.0, 0.0});
    for (const int c : network_.cylinders) {
        costs[at(c)][at(1 - counts.rows[at(c)] % 2)] = kForbidden;
    }
    const auto parities =
        choose_row_parities(network_, colour_ends(network_, counts.arc_cells), counts.twist, costs);
    for (const int c : network_.cylinders) {
        if (parities[at(c)] && counts.rows[at(c)] % 2 != *parities[at(c)]) {
            throw Error(ErrorKind::BadOption, "odd-rows",
                        fmt::format("{}.rows: with {} rows in cylinder {} colours don't alternate "
                                    "across junctions; use one more or less (or grid.parity any)",
                                    wish_.paths[at(c)], counts.rows[at(c)], c));
        }
    }
}

}  // namespace leafcutter::geometry
