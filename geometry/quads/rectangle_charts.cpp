#include "geometry/quads/rectangle_charts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "geometry/harmonic/bijectivity.h"
#include "geometry/harmonic/chart_map.h"
#include "geometry/intrinsic_delaunay.h"
#include "geometry/laplacian.h"
#include "geometry/quads/spacing.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// f as it is to be on the flanks.
std::vector<double> bent_flank(const RectanglePlan& plan, const Flank& flank) {
    std::vector<double> levels;
    for (std::size_t u = 0; u < flank.uses.size(); ++u) {
        const CriticalSide& side = plan.network.sides[at(flank.uses[u].side)];
        const std::size_t last =
            u + 1 < flank.uses.size() ? flank.uses[u + 1].first : flank.vertices.size();
        for (std::size_t i = flank.uses[u].first; i < last; ++i) {
            levels.push_back(plan.rows.bent(side, flank.f[i]));
        }
    }
    return levels;
}

// By how much rows climb from one flank to the other, at most.
double slant_deg(const RectanglePlan& plan, int cylinder) {
    double least = 0.0;
    double most = 0.0;
    for (std::size_t which = 0; which < 2; ++which) {
        for (const SideUse& use : plan.network.flanks[at(cylinder)][which].uses) {
            const CriticalSide& side = plan.network.sides[at(use.side)];
            const double lift = plan.rows.bent(side, side.f.front()) - side.f.front();
            const double signed_lift = which == SideNetwork::Right ? lift : -lift;
            least = std::min(least, signed_lift);
            most = std::max(most, signed_lift);
        }
    }
    const double width = plan.foliation.cylinders[at(cylinder)].width;
    return std::atan((most - least) / width) * 180.0 / std::numbers::pi;
}

}  // namespace

Cylinder bend_chart(const RectanglePlan& plan, int cylinder, const Context& context) {
    const Cylinder& chart = plan.foliation.cylinders[at(cylinder)];
    const auto& flanks = plan.network.flanks[at(cylinder)];
    const auto& ends = plan.network.ends[at(cylinder)];
    ChartMap map = reopen_chart(chart);
    std::vector<char> held(map.gf.size(), 0);
    Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size()));
    for (const Flank& flank : flanks) {
        const std::vector<double> levels = bent_flank(plan, flank);
        for (std::size_t i = 0; i < levels.size(); ++i) {
            held[at(flank.vertices[i])] = 1;
            values[flank.vertices[i]] = levels[i] - map.gf[at(flank.vertices[i])].y();
        }
    }
    for (const std::vector<int>& end : ends) {
        for (const int v : end) {
            held[at(v)] = 1;
            values[v] = 0.0;
        }
    }
    const std::vector<WeightedEdge> edges =
        cotangent_edges(intrinsic_delaunay(map.mesh, map.edges));
    const Eigen::VectorXd more = HarmonicSolver(edges, held).solve(std::move(values));
    for (std::size_t v = 0; v < map.gf.size(); ++v) {
        map.gf[v].y() += more[static_cast<Eigen::Index>(v)];
    }
    make_bijective(map,
                   {{ends[0], 0, false},
                    {flanks[SideNetwork::Right].vertices, 1, false},
                    {ends[1], 0, false},
                    {flanks[SideNetwork::Left].vertices, 1, false}},
                   context);
    Cylinder out = chart;
    out.corner_gf = finish_cylinder(std::move(map)).corner_gf;
    return out;
}

CylinderGrid rectangle_grid(const RectanglePlan& plan, const Cylinder& chart, int cylinder) {
    const LevelScale f_scale(chart, Axis::F, 0.0);
    const LevelScale g_scale(chart, Axis::G, 0.0);
    const int cols = plan.counts.cols[at(cylinder)];
    std::vector<double> levels = plan.rows.levels(cylinder);
    const int rows = static_cast<int>(levels.size()) - 1;
    return {.shape = ChartShape::Rectangle,
            .rows = rows,
            .cols = cols,
            .column_shift = 0,
            .shear_deg = slant_deg(plan, cylinder),
            .stretch = f_scale.total_mm() / rows / (g_scale.total_mm() / cols),
            .f_levels = std::move(levels),
            .g_levels = g_scale.levels(cols)};
}

}  // namespace leafcutter::geometry
