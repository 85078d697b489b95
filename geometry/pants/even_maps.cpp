#include "geometry/pants/even_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include <Eigen/Core>

#include "geometry/cell_spread.h"
#include "geometry/error.h"
#include "geometry/parallel.h"

namespace leafcutter::geometry {
namespace {

// Rows are averaged over as many bands of each cylinder, with the order of LevelScale's means.
constexpr std::size_t kBands = 32;
constexpr double kOrder = 3.0;
constexpr double kFewestRows = 3.0;
// What a missing row of three costs, in units of the variation.
constexpr double kRowCost = 0.5;
// Steps of all logarithms of weights, one round each.
constexpr std::array<double, 6> kSteps{0.5, 0.5, 0.35, 0.25, 0.15, 0.1};
constexpr std::size_t kStarts = 3;
// With more cylinders a round is dear.
constexpr std::size_t kManyCylinders = 15;
constexpr std::size_t kRoundsOfMany = 2;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// The part of the surface on one graph edge, by bands along f.
struct Ring {
    double flat = 0.0;
    double factors = 0.0;                    // Sum of flat area x conformal factor^order.
    std::array<double, kBands> band_flat{};  // Per band the same sums.
    std::array<double, kBands> band_factors{};
    double circumference = 0.0;

    // Mean width on the surface per unit of f, at a band; of g, everywhere.
    double row_scale(std::size_t band) const {
        return band_flat[band] > 0.0 ? std::pow(band_factors[band] / band_flat[band], 1.0 / kOrder)
                                     : 0.0;
    }
    double column_scale() const { return std::pow(factors / flat, 1.0 / kOrder); }
};

struct Share {
    FlatArea area;
    std::size_t ring = 0;
    std::size_t band = 0;
};

// Area times squared gradient of the map on a triangle: its area in the flat metric. In the tree
// the three corners lie on a line but for the few triangles round singular points.
double flat_area(double area,
                 const std::array<Eigen::Vector3d, 3>& corners,
                 const std::array<double, 3>& distances) {
    const auto longest = static_cast<std::size_t>(
        std::max_element(distances.begin(), distances.end()) - distances.begin());
    // The edge from corner i to i + 1 has distance i.
    const Eigen::Vector3d& a = corners[longest];
    const Eigen::Vector3d along = corners[(longest + 1) % 3] - a;
    const Eigen::Vector3d aside = corners[(longest + 2) % 3] - a;
    const double rise = distances[longest];
    const double rise_aside =
        0.5 * (distances[(longest + 2) % 3] + rise - distances[(longest + 1) % 3]);
    const double doubled = std::max(2.0 * area, 1e-300);
    return (rise * aside - rise_aside * along).squaredNorm() / (2.0 * doubled);
}

// Per vertex a third of its triangles: single triangles of a coarse mesh are too uneven.
std::vector<Share> shares_of(const Hierarchy::Level& level, const GraphMap& map) {
    const HalfEdges& edges = level.flipped.half_edges;
    const VertexRings& rings = level.flipped.rings;
    std::vector<Share> shares(map.t.size());
    double all = 0.0;
    for (std::size_t t = 0; t < level.flipped.area.size(); ++t) {
        std::array<int, 3> vertices{};
        std::array<Eigen::Vector3d, 3> corners;
        std::array<double, 3> distances{};
        for (std::size_t k = 0; k < 3; ++k) {
            const int h = static_cast<int>(3 * t + k);
            const std::size_t edge = at(rings.edge_of_half_edge[at(h)]);
            vertices[k] = edges.from_of(h);
            corners[k] = level.surface.mesh.positions[at(vertices[k])];
            distances[k] =
                map.distance(rings.edges[edge].from, rings.edges[edge].to, map.words[edge]);
        }
        const double area = level.flipped.area[t];
        const double flat = flat_area(area, corners, distances);
        all += flat;
        for (const int v : vertices) {
            shares[at(v)].area.surface += area / 3.0;
            shares[at(v)].area.flat += flat / 3.0;
        }
    }
    const double least = 1e-9 * all / static_cast<double>(shares.size());
    for (std::size_t v = 0; v < shares.size(); ++v) {
        const int edge = map.graph_edge[v];
        const double place = map.t[v] / map.weight(edge) * static_cast<double>(kBands);
        shares[v].area.flat = std::max(shares[v].area.flat, least);
        shares[v].ring = at(edge);
        shares[v].band =
            static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(kBands - 1)));
    }
    return shares;
}

std::vector<Ring> rings_of(const std::vector<Share>& shares, const GraphMap& map) {
    std::vector<Ring> rings(map.graph.edges.size());
    for (const Share& share : shares) {
        const double factor = std::sqrt(share.area.surface / share.area.flat);
        const double weighted = share.area.flat * std::pow(factor, kOrder);
        Ring& ring = rings[share.ring];
        ring.flat += share.area.flat;
        ring.factors += weighted;
        ring.band_flat[share.band] += share.area.flat;
        ring.band_factors[share.band] += weighted;
    }
    for (std::size_t e = 0; e < rings.size(); ++e) {
        rings[e].circumference = rings[e].flat / map.graph.edges[e].weight;
    }
    return rings;
}

double badness(const GridForecast& forecast) {
    const double missing = std::max(0.0, kFewestRows - forecast.least_rows) / kFewestRows;
    return forecast.variation + kRowCost * missing;
}

class Evener {
public:
    Evener(const Hierarchy::Level& level, double cells, const Context& context)
        : level_(level), cells_(cells), context_(context) {}

    double badness_of(const CoarseMap& map) const {
        return badness(forecast_grid(level_, map.map, cells_));
    }

    // One round: every weight up and down, then all of them together.
    CoarseMap improve(CoarseMap start, double step) const {
        const std::size_t count = start.map.graph.edges.size();
        const double here = badness_of(start);
        std::vector<std::vector<double>> moves;
        for (std::size_t e = 0; e < count; ++e) {
            for (const double by : {-step, step}) {
                moves.emplace_back(count, 0.0);
                moves.back()[e] = by;
            }
        }
        std::vector<Tried> tried = try_all(start, moves);
        const std::vector<double> combined = lowest_together(tried, here, step);
        const auto part = [&combined](double of) {
            std::vector<double> move = combined;
            std::for_each(move.begin(), move.end(), [of](double& by) { by *= of; });
            return move;
        };
        std::vector<Tried> together = try_all(start, {part(1.0), part(0.6), part(0.3)});
        std::move(together.begin(), together.end(), std::back_inserter(tried));
        const auto best =
            std::min_element(tried.begin(), tried.end(),
                             [](const Tried& a, const Tried& b) { return a.badness < b.badness; });
        return best->badness < here ? std::move(best->map) : std::move(start);
    }

private:
    struct Tried {
        CoarseMap map;
        double badness = 0.0;
    };

    std::vector<Tried> try_all(const CoarseMap& start,
                               const std::vector<std::vector<double>>& moves) const {
        std::vector<Tried> tried(moves.size());
        for_each_task(moves.size(), context_, [&](std::size_t i, const Context& own) {
            std::vector<double> weights;
            double mean = 0.0;
            for (const double by : moves[i]) {
                mean += by / static_cast<double>(moves[i].size());
            }
            for (std::size_t e = 0; e < moves[i].size(); ++e) {
                weights.push_back(start.map.graph.edges[e].weight * std::exp(moves[i][e] - mean));
            }
            tried[i].map = with_other_weights(level_, start, weights, own);
            tried[i].badness = badness_of(tried[i].map);
        });
        return tried;
    }

    // Each weight's move to the lowest point of the parabola through its two trials.
    static std::vector<double> lowest_together(const std::vector<Tried>& tried,
                                               double here,
                                               double step) {
        std::vector<double> moves;
        for (std::size_t e = 0; 2 * e + 1 < tried.size(); ++e) {
            const double below = tried[2 * e].badness;
            const double above = tried[2 * e + 1].badness;
            const double bend = below + above - 2.0 * here;
            const double lowest =
                bend > 0.0 ? 0.5 * (below - above) / bend : (below < above ? -1.0 : 1.0);
            moves.push_back(step * std::clamp(lowest, -1.0, 1.0));
        }
        return moves;
    }

    const Hierarchy::Level& level_;
    double cells_;
    const Context& context_;
};

}  // namespace

GridForecast forecast_grid(const Hierarchy::Level& level, const GraphMap& map, double cells) {
    const std::vector<Share> shares = shares_of(level, map);
    const std::vector<Ring> rings = rings_of(shares, map);
    // Areas of cells as wide and long as a unit of g is there, on average.
    double surface = 0.0;
    double number = 0.0;
    double weighted = 0.0;
    for (const Share& share : shares) {
        const Ring& ring = rings[share.ring];
        const double cell =
            share.area.surface / share.area.flat * ring.column_scale() / ring.row_scale(share.band);
        surface += share.area.surface;
        number += share.area.surface / cell;
        weighted += share.area.surface * cell;
    }
    GridForecast forecast;
    forecast.variation = std::sqrt(std::max(0.0, number * weighted / (surface * surface) - 1.0));
    const double unit = std::sqrt(number / cells);  // Of g, in a cell.
    forecast.least_rows = cells;
    for (std::size_t e = 0; e < rings.size(); ++e) {
        const double band = map.graph.edges[e].weight / static_cast<double>(kBands);
        double length = 0.0;
        for (std::size_t b = 0; b < kBands; ++b) {
            length += band * rings[e].row_scale(b);
        }
        forecast.least_rows =
            std::min(forecast.least_rows, length / (unit * rings[e].column_scale()));
    }
    return forecast;
}

std::vector<CoarseMap> even_maps(const Hierarchy& hierarchy,
                                 std::vector<CoarseMap> maps,
                                 double cells,
                                 const Context& context) {
    const Evener evener(hierarchy.levels.back(), cells, context);
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < maps.size(); ++i) {
        order.emplace_back(evener.badness_of(maps[i]), i);
    }
    std::sort(order.begin(), order.end());
    // The best starts compete for a round; the best of them goes on.
    std::vector<std::pair<double, CoarseMap>> evened;
    for (std::size_t k = 0; k < std::min(kStarts, order.size()); ++k) {
        CoarseMap better = evener.improve(maps[order[k].second], kSteps.front());
        evened.emplace_back(evener.badness_of(better), std::move(better));
    }
    std::stable_sort(evened.begin(), evened.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    CoarseMap& best = evened.front().second;
    const bool many = best.map.graph.edges.size() > kManyCylinders;
    for (std::size_t round = 1; round < (many ? kRoundsOfMany : kSteps.size()); ++round) {
        best = evener.improve(std::move(best), kSteps[round]);
    }
    std::vector<CoarseMap> all;
    for (auto& [badness, map] : evened) {
        map.name += ", even cells";
        all.push_back(std::move(map));
    }
    std::move(maps.begin(), maps.end(), std::back_inserter(all));
    return all;
}

}  // namespace leafcutter::geometry
