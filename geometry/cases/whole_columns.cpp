#include "geometry/cases/whole_columns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/pants/fit_weights.h"
#include "geometry/quads/critical_arcs.h"
#include "geometry/quads/junction_counts.h"

namespace leafcutter::geometry {
namespace {

constexpr double kGivenSlack = 0.05;
constexpr double kAutomaticSlack = 0.15;
// The coarse level's circumferences are not quite the charts': once more, if by this many columns.
constexpr int kMostRounds = 2;
constexpr double kWorthAnotherRound = 0.03;
// A map that is solved again costs as much as the first; on large surfaces once is enough.
constexpr std::size_t kLargeSurface = 200'000;
// One solve for each cylinder: of so many it costs more than it gains.
constexpr std::size_t kMostCylinders = 15;
// Counts that fit together only with so many more cells than wanted are no aim.
constexpr double kMostExcess = 1.1;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Of all joined cylinders, or nothing where no counts fit together.
std::optional<JunctionCounts> counts_of(const Foliation& foliation,
                                        const JunctionAim& aim,
                                        const Context& context) {
    const ArcNetwork network = find_arcs(foliation);
    if (network.cylinders.size() != foliation.cylinders.size()) {
        return std::nullopt;
    }
    JunctionWish wish;
    wish.cells = aim.cells;
    wish.parity = aim.even_columns ? Parity::Even : Parity::Any;
    wish.counts.resize(foliation.cylinders.size());
    wish.paths.assign(foliation.cylinders.size(), "grid");
    const JunctionCounter counter(foliation, network, std::move(wish));
    return counter.choose(counter.wanted_cells(), context);
}

std::size_t triangles_of(const Foliation& foliation) {
    std::size_t count = 0;
    for (const Cylinder& cylinder : foliation.cylinders) {
        count += cylinder.mesh.triangles.size();
    }
    return count;
}

// The foliation, the coarse map it came from, and the counts that suit it best.
struct Stand {
    Foliation foliation;
    GraphMap coarse;
    JunctionCounts counts;
};

// What the coarse level's circumferences must be in proportion to, so that those of the charts are
// to `columns`.
CircumferenceWish wish_for(const Stand& stand,
                           const Hierarchy::Level& level,
                           const std::vector<int>& columns) {
    const std::vector<double> coarse =
        circumferences(stand.coarse, level.flipped.rings, level.flipped.weights);
    CircumferenceWish wish;
    for (const Cylinder& cylinder : stand.foliation.cylinders) {
        const std::size_t e = at(cylinder.graph_edge);
        wish.columns.push_back(columns[e]);
        wish.circumferences.push_back(columns[e] * coarse[e] / cylinder.width);
    }
    return wish;
}

// How many columns the cylinder with the worst circumference is off, at the best common scale.
double furthest_off(const Foliation& foliation, const std::vector<int>& columns) {
    double mean = 0.0;
    for (std::size_t c = 0; c < columns.size(); ++c) {
        mean += std::log(foliation.cylinders[c].width / columns[c]);
    }
    mean /= static_cast<double>(columns.size());
    double worst = 0.0;
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const double off = std::log(foliation.cylinders[c].width / columns[c]) - mean;
        worst = std::max(worst, std::abs(off) * columns[c]);
    }
    return worst;
}

// A failure is not the caller's: there is a foliation that does without.
std::optional<Stand> reweighed(const Stand& stand,
                               const Origin& origin,
                               const CircumferenceWish& wish,
                               const JunctionAim& aim,
                               const Context& context) {
    try {
        Stand next;
        next.coarse = fit_weights(origin.level, stand.coarse, wish, context);
        next.foliation = origin.refoliate(next.coarse);
        std::optional<JunctionCounts> counts = counts_of(next.foliation, aim, context);
        if (counts) {
            next.counts = std::move(*counts);
            return next;
        }
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::SelfCheck && error.kind() != ErrorKind::BadOption) {
            throw;
        }
    }
    return std::nullopt;
}

}  // namespace

Foliation with_whole_columns(Foliation foliation,
                             const Origin& origin,
                             const FoliationOptions& options,
                             const Context& context) {
    const JunctionAim& aim = *options.junctions;
    if (foliation.cylinders.size() < 2 || foliation.cylinders.size() > kMostCylinders) {
        return foliation;
    }
    Stand best;
    try {
        std::optional<JunctionCounts> counts = counts_of(foliation, aim, context);
        if (!counts || counts->cells > kMostExcess * aim.cells) {
            return foliation;
        }
        best.counts = std::move(*counts);
    } catch (const Error&) {
        return foliation;  // Too few cells for the topology: the grid says so.
    }
    best.foliation = std::move(foliation);
    best.coarse = origin.coarse;
    const std::vector<double> home = weights_of(best.foliation.graph);
    const double slack = options.weights ? kGivenSlack : kAutomaticSlack;
    Stand last = best;
    const std::vector<int> columns = best.counts.cols;
    const int rounds = triangles_of(last.foliation) > kLargeSurface ? 1 : kMostRounds;
    for (int round = 0;
         round < rounds && furthest_off(last.foliation, columns) > kWorthAnotherRound; ++round) {
        CircumferenceWish wish = wish_for(last, origin.level, columns);
        wish.weights = home;
        wish.most_change = slack;
        std::optional<Stand> next = reweighed(last, origin, wish, aim, context);
        if (!next) {
            break;
        }
        last = std::move(*next);
        if (last.counts.distortion < best.counts.distortion) {
            best = last;
        }
    }
    return std::move(best.foliation);
}

}  // namespace leafcutter::geometry
