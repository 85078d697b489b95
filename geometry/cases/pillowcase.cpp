#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "geometry/cases/finish.h"
#include "geometry/cases/sphere.h"
#include "geometry/cases/sphere_cover.h"
#include "geometry/cases/sphere_points.h"
#include "geometry/cases/sphere_slice.h"
#include "geometry/cell_spread.h"
#include "geometry/harmonic/resolve.h"
#include "geometry/laplacian.h"

namespace leafcutter::geometry {
namespace {

using Points = std::array<int, 4>;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// A chart of the cover, and what is needed to make it odd again after repairs.
struct CoverChart {
    ChartSurface surface;
    BranchedCover cover;
    OddCochains cochains;
    Eigen::Matrix2d frame;  // From the values of the two forms to (g, f).

    // (g, f) of a vertex above plus that of the other one above.
    Eigen::Vector2d fold(std::size_t below) const {
        return frame * Eigen::Vector2d(cochains.fold[0][below], cochains.fold[1][below]);
    }
};

std::vector<Jump> paired(const std::array<Cochain, 2>& cochains) {
    std::vector<Jump> out;
    out.reserve(cochains[0].size());
    for (std::size_t h = 0; h < cochains[0].size(); ++h) {
        out.push_back({cochains[0][h], cochains[1][h]});
    }
    return out;
}

template <typename JumpOfHalfEdge>
std::vector<Jump> edge_jumps(const std::vector<WeightedEdge>& edges, const JumpOfHalfEdge& jump) {
    std::vector<Jump> out;
    out.reserve(edges.size());
    for (const WeightedEdge& edge : edges) {
        out.push_back(jump(edge.half_edge));
    }
    return out;
}

// Solves on the double cover of `surface`; the answer's map is the cover's.
SolvedChart solve_on_cover(const ChartSurface& surface,
                           const Points& points,
                           CoverChart& chart,
                           const Context& context) {
    chart.surface = surface;
    chart.cover =
        branched_cover(surface.edges, static_cast<int>(surface.mesh.positions.size()), points);
    chart.cochains = odd_cochains(chart.cover, points[0]);
    SolvedChart solved;
    solved.map.mesh = cover_mesh(surface.mesh, chart.cover);
    solved.map.edges = chart.cover.edges;
    solved.map.gf.resize(chart.cover.vertex_below.size());
    context.check();
    const IntrinsicTriangulation delaunay =
        intrinsic_delaunay(solved.map.mesh, solved.map.edges, paired(chart.cochains.jump));
    context.check();
    const std::vector<WeightedEdge> edges = cotangent_edges(delaunay);
    const std::vector<Jump> jump = edge_jumps(edges, [&](int h) { return delaunay.jump[at(h)]; });
    const HarmonicForms forms = solve_odd_forms(chart.cover, chart.cochains, edges, jump);
    context.check();
    const auto [rising, round] = shortest_classes(forms);
    chart.frame = lay_out_torus(solved, forms, {rising, round});
    solved.flux_mismatch = periodic_flux_variation(
        edges, rising.x() * forms.values[0] + rising.y() * forms.values[1], jumps_of(rising, jump));
    return solved;
}

// The nearest chart in which the exchange of sheets is a half turn about (0, 0), which is at the
// first of the points. A shift of the whole chart falls out.
void make_odd(ChartMap& map, const CoverChart& chart) {
    const BranchedCover& cover = chart.cover;
    for (std::size_t v = 0; v < cover.above.size(); ++v) {
        const auto [one, other] = cover.above[v];
        const Eigen::Vector2d fold = chart.fold(v);
        const Eigen::Vector2d half_apart = 0.5 * (map.gf[at(one)] - map.gf[at(other)]);
        map.gf[at(one)] = 0.5 * fold + half_apart;
        map.gf[at(other)] = 0.5 * fold - half_apart;
    }
}

// With positive weights the odd solution is an embedding of the cover (Gortler, Gotsman and
// Thurston 2006), whatever the triangles.
void solve_with_positive_weights(ChartMap& map, const CoverChart& chart) {
    const std::vector<WeightedEdge> edges = positive_edges(map.mesh, map.edges);
    const std::vector<Jump> jump = edge_jumps(edges, [&](int h) {
        return Jump{chart.cochains.jump[0][at(h)], chart.cochains.jump[1][at(h)]};
    });
    const HarmonicForms forms = solve_odd_forms(chart.cover, chart.cochains, edges, jump);
    for (std::size_t v = 0; v < map.gf.size(); ++v) {
        const auto i = static_cast<Eigen::Index>(v);
        map.gf[v] = chart.frame * Eigen::Vector2d(forms.values[0][i], forms.values[1][i]);
    }
}

FlipReport make_odd_bijective(ChartMap& map, const CoverChart& chart, const Context& context) {
    FlipReport report = make_bijective(map, {}, context);
    if (report.flipped_as_solved > 0) {
        make_odd(map, chart);
        if (!bad_triangles(map).empty()) {
            context.check();
            report.whole_chart = true;
            solve_with_positive_weights(map, chart);
        }
    }
    return report;
}

// Lower then upper boundary. The surface lies left of both, so g grows along the lower and falls
// along the upper.
std::vector<Rail> rails_of(const PillowChart& pillow) {
    const int lower = pillow.folds[0][0];
    const int upper = pillow.folds[1][0];
    Rail bottom{boundary_path(pillow.map.edges, lower, lower), 0, true};
    Rail top{boundary_path(pillow.map.edges, upper, upper), 0, true};
    std::reverse(top.vertices.begin(), top.vertices.end());
    return {std::move(bottom), std::move(top)};
}

std::vector<Eigen::Vector3d> arc_between(const ChartMap& map, const std::array<int, 2>& ends) {
    std::vector<Eigen::Vector3d> arc;
    for (const int v : boundary_path(map.edges, ends[0], ends[1])) {
        arc.push_back(map.mesh.positions[at(v)]);
    }
    return arc;
}

void check_points(const TriangleMesh& mesh, const std::vector<int>& near) {
    const auto is_vertex = [&](int v) {
        return v >= 0 && v < static_cast<int>(mesh.positions.size());
    };
    std::vector<int> sorted = near;
    std::sort(sorted.begin(), sorted.end());
    if (near.size() > 4) {
        throw Error(ErrorKind::BadOption, "too-many-near",
                    fmt::format("foliation.singularities: {} wanted, but a pillowcase has four "
                                "corners",
                                near.size()));
    }
    if (!std::all_of(near.begin(), near.end(), is_vertex) ||
        std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
        throw Error(ErrorKind::BadOption, "bad-near",
                    "foliation.singularities: must be near different vertices of the model");
    }
}

Points singular_points(const TriangleMesh& mesh,
                       const FoliationOptions& options,
                       const Context& context) {
    check_points(mesh, options.near);
    if (options.near.size() < 4) {
        return choose_pillow_points(mesh, options.near, context);
    }
    return {options.near[0], options.near[1], options.near[2], options.near[3]};
}

// No edge may join two singular points: such edges are split.
ChartSurface surface_for(const TriangleMesh& mesh, const Points& points) {
    std::vector<std::uint8_t> lines(mesh.positions.size(), 0);
    for (const int point : points) {
        lines[at(point)] = 1;
    }
    return start_surface(mesh, std::move(lines));
}

Foliation finish_pillow(SolvedChart on_cover,
                        const CoverChart& chart,
                        const Points& points,
                        const Context& context) {
    PillowChart pillow =
        slice_pillowcase(chart.surface, chart.cover, std::move(on_cover.map), points);
    context.check();
    Foliation result;
    for (const std::array<int, 2>& ends : pillow.folds) {
        result.critical_graph.push_back(arc_between(pillow.map, ends));
        for (const int point : ends) {
            result.singularities.push_back({pillow.map.mesh.positions[at(point)], 1});
        }
    }
    SolvedChart solved;
    const std::vector<Rail> rails = rails_of(pillow);
    solved.map = std::move(pillow.map);
    // Half the cover, twice as large: a ring of the torus on half its height.
    solved.upper = 2.0 * on_cover.upper;
    solved.lower = 2.0 * on_cover.lower;
    solved.flux_mismatch = on_cover.flux_mismatch;
    Foliation finished = finish_foliation(std::move(solved), rails, context);
    finished.singularities = std::move(result.singularities);
    finished.critical_graph = std::move(result.critical_graph);
    return finished;
}

}  // namespace

Foliation foliate_pillowcase(const TriangleMesh& mesh,
                             const FoliationOptions& options,
                             const Context& context) {
    const Points points = singular_points(mesh, options, context);
    CoverChart chart;
    SolvedChart on_cover = solve_resolved(
        surface_for(mesh, points),
        [&](const ChartSurface& surface) {
            return solve_on_cover(surface, points, chart, context);
        },
        options.refinement, context);
    const FlipReport repair = make_odd_bijective(on_cover.map, chart, context);
    Foliation foliation = finish_pillow(std::move(on_cover), chart, points, context);
    for (std::string& warning : repair_warnings(repair)) {
        foliation.warnings.push_back(std::move(warning));
    }
    foliation.mode = FoliationMode::SpherePillowcase;
    foliation.graph = {2, {{0, 1, 1.0}}};
    foliation.spread = cell_spread(foliation.cylinders);
    return foliation;
}

}  // namespace leafcutter::geometry
