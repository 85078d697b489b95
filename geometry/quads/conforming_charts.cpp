#include "geometry/quads/conforming_charts.h"

#include <cmath>
#include <numbers>
#include <utility>

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

// What is added to g, per vertex: on ends what brings them to their columns, inside harmonic.
Eigen::VectorXd correction(const ChartMap& map,
                           const std::array<CylinderEnd, 2>& ends,
                           const JunctionCounts& counts,
                           int cylinder) {
    std::vector<char> held(map.gf.size(), 0);
    Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size()));
    for (std::size_t side = 0; side < 2; ++side) {
        const CylinderEnd& end = ends[side];
        if (end.uses.empty()) {
            continue;
        }
        const std::vector<double> columns = column_positions(end, counts.arc_cells);
        const double column = map.width / columns.back();
        const int twist = side == 1 ? counts.twist[at(cylinder)] : 0;
        for (std::size_t i = 0; i < end.vertices.size(); ++i) {
            const int v = end.vertices[i];
            held[at(v)] = 1;
            values[v] = column * (columns[i] + twist) - end.g[i];
        }
    }
    const std::vector<WeightedEdge> edges =
        cotangent_edges(intrinsic_delaunay(map.mesh, map.edges));
    return HarmonicSolver(edges, held).solve(std::move(values));
}

}  // namespace

Cylinder conform_chart(const Foliation& foliation,
                       const ArcNetwork& network,
                       const JunctionCounts& counts,
                       int cylinder,
                       const Context& context) {
    const Cylinder& chart = foliation.cylinders[at(cylinder)];
    const auto& ends = network.ends[at(cylinder)];
    ChartMap map = reopen_chart(chart);
    const Eigen::VectorXd more = correction(map, ends, counts, cylinder);
    for (std::size_t v = 0; v < map.gf.size(); ++v) {
        map.gf[v].x() += more[static_cast<Eigen::Index>(v)];
    }
    make_bijective(map, {{ends[0].vertices, 0, true}, {ends[1].vertices, 0, true}}, context);
    lift_into_domain(map);
    Cylinder out = chart;
    out.corner_gf = finish_cylinder(std::move(map)).corner_gf;
    return out;
}

CylinderGrid conforming_grid(const Cylinder& chart, const JunctionCounts& counts, int cylinder) {
    const LevelScale f_scale(chart, Axis::F, 0.0);
    const LevelScale g_scale(chart, Axis::G, 0.0);
    const int rows = counts.rows[at(cylinder)];
    const int cols = counts.cols[at(cylinder)];
    const double aside = counts.slip[at(cylinder)] * chart.width / cols;
    CylinderGrid grid{.shape = chart.shape,
                      .rows = rows,
                      .cols = cols,
                      .column_shift = 0,
                      .shear_deg = std::atan(aside / chart.height) * 180.0 / std::numbers::pi,
                      .stretch = f_scale.total_mm() / rows / (g_scale.total_mm() / cols),
                      .f_levels = f_scale.levels(rows),
                      .g_levels = {}};
    if (at(cylinder) < counts.f_levels.size() && !counts.f_levels[at(cylinder)].empty()) {
        grid.f_levels = counts.f_levels[at(cylinder)];
    }
    for (int j = 0; j <= cols; ++j) {
        grid.g_levels.push_back(chart.width * j / cols);
    }
    return grid;
}

}  // namespace leafcutter::geometry
