#include "geometry/cases/annulus.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "geometry/cases/corners.h"
#include "geometry/cases/finish.h"
#include "geometry/harmonic/resolve.h"
#include "geometry/laplacian.h"
#include "geometry/loops/tree_cotree.h"

namespace leafcutter::geometry {
namespace {

constexpr double kTrianglesInCell = 4.0;
constexpr std::size_t kManyTriangles = 30'000;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

Eigen::VectorXd between_loops(const std::vector<WeightedEdge>& edges,
                              const std::vector<int>& loop_of_vertex) {
    std::vector<char> held(loop_of_vertex.size(), 0);
    Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size()));
    for (std::size_t v = 0; v < held.size(); ++v) {
        held[v] = loop_of_vertex[v] >= 0 ? 1 : 0;
        values[static_cast<Eigen::Index>(v)] = loop_of_vertex[v] == 1 ? 1.0 : 0.0;
    }
    return HarmonicSolver(edges, held).solve(std::move(values));
}

// The multivalued harmonic function with natural boundary conditions that rises by one round the
// ring.
struct Conjugate {
    Eigen::VectorXd values;
    double energy = 0.0;
};

Conjugate round_the_ring(const std::vector<WeightedEdge>& edges,
                         const IntrinsicTriangulation& delaunay,
                         int origin) {
    std::vector<double> jump;
    jump.reserve(edges.size());
    for (const WeightedEdge& edge : edges) {
        jump.push_back(delaunay.jump[at(edge.half_edge)][0]);
    }
    std::vector<char> held(at(delaunay.vertex_count), 0);
    held[at(origin)] = 1;
    Conjugate out;
    out.values =
        HarmonicSolver(edges, held).solve(Eigen::VectorXd::Zero(delaunay.vertex_count), jump);
    out.energy = dirichlet_energy(edges, out.values, jump);
    return out;
}

// Sets coordinates so that (g, f) is right-handed.
void set_coordinates(ChartMap& map,
                     const Eigen::VectorXd& f,
                     const Conjugate& conjugate,
                     const Cochain& arc) {
    const auto set = [&](double scale) {
        for (std::size_t v = 0; v < map.gf.size(); ++v) {
            const auto i = static_cast<Eigen::Index>(v);
            map.gf[v] = {scale * conjugate.values[i], f[i]};
        }
        for (std::size_t h = 0; h < arc.size(); ++h) {
            map.jump[h] = {scale * arc[h], 0.0};
        }
    };
    map.jump.resize(arc.size());
    set(map.width);
    if (chart_area(map) < 0.0) {
        set(-map.width);
    }
}

std::vector<std::uint8_t> lines_of_vertices(const std::array<std::vector<int>, 2>& loops,
                                            std::size_t vertices) {
    std::vector<std::uint8_t> lines(vertices, 0);
    for (std::size_t k = 0; k < 2; ++k) {
        for (const int v : loops[k]) {
            lines[at(v)] = static_cast<std::uint8_t>(1U << k);
        }
    }
    return lines;
}

// `lines` has bit 0 for the lower loop, bit 1 for the upper. g is 0 at `origin`.
SolvedChart solve_ring(const ChartSurface& surface, int origin) {
    SolvedChart solved;
    ChartMap& map = solved.map;
    map = start_chart(surface);
    std::vector<int> loop_of_vertex(surface.lines.size());
    std::transform(surface.lines.begin(), surface.lines.end(), loop_of_vertex.begin(),
                   [](std::uint8_t lines) { return static_cast<int>(lines) - 1; });
    const Cochain arc = arc_cochain(map.edges, loop_of_vertex, 0, 1);
    std::vector<Jump> jump(arc.size());
    std::transform(arc.begin(), arc.end(), jump.begin(), [](int j) { return Jump{j, 0}; });
    const IntrinsicTriangulation delaunay = intrinsic_delaunay(map.mesh, map.edges, jump);
    const std::vector<WeightedEdge> edges = cotangent_edges(delaunay);
    const Eigen::VectorXd f = between_loops(edges, loop_of_vertex);
    const Conjugate conjugate = round_the_ring(edges, delaunay, origin);
    solved.upper = 2.0 * dirichlet_energy(edges, f);
    solved.lower = 1.0 / (2.0 * conjugate.energy);
    solved.flux_mismatch = flux_variation(edges, f);
    map.shape = ChartShape::Annulus;
    map.height = 1.0;
    map.width = std::sqrt(solved.upper * solved.lower);
    set_coordinates(map, f, conjugate, arc);
    return solved;
}

// Where cells will be hardly larger than triangles their corners would follow each triangle's own
// slope: all triangles are split, flat.
ChartSurface fine_enough(ChartSurface surface,
                         const FoliationOptions& options,
                         const Context& context) {
    if (!options.junctions || options.refinement == Refinement::Off) {
        return surface;
    }
    const double wanted = kTrianglesInCell * options.junctions->cells;
    while (static_cast<double>(surface.mesh.triangles.size()) < wanted &&
           surface.mesh.triangles.size() < kManyTriangles) {
        context.check();
        const std::vector<char> all(surface.edges.from.size(), 1);
        surface = split_edges(std::move(surface), all);
    }
    return surface;
}

}  // namespace

Foliation foliate_annulus(const TriangleMesh& mesh,
                          const std::array<std::vector<int>, 2>& loops,
                          const FoliationOptions& options,
                          const Context& context) {
    if (arc_lengths(mesh, loops[1]).back() > arc_lengths(mesh, loops[0]).back()) {
        return foliate_ring(mesh, {loops[1], loops[0]}, options, context);
    }
    return foliate_ring(mesh, loops, options, context);
}

Foliation foliate_ring(const TriangleMesh& mesh,
                       const std::array<std::vector<int>, 2>& rings,
                       const FoliationOptions& options,
                       const Context& context) {
    const int lower = rings[0].front();
    const int upper = rings[1].front();
    SolvedChart solved = solve_resolved(
        fine_enough(start_surface(mesh, lines_of_vertices(rings, mesh.positions.size())), options,
                    context),
        [lower](const ChartSurface& surface) { return solve_ring(surface, lower); },
        options.refinement, context);
    // The surface lies left of both loops, so g grows along the lower and falls along the upper.
    Rail bottom{boundary_path(solved.map.edges, lower, lower), 0, true};
    Rail top{boundary_path(solved.map.edges, upper, upper), 0, true};
    std::reverse(top.vertices.begin(), top.vertices.end());
    Foliation foliation =
        finish_foliation(std::move(solved), {std::move(bottom), std::move(top)}, context);
    foliation.mode = FoliationMode::Annulus;
    foliation.graph = {2, {{0, 1, 1.0}}};
    return foliation;
}

}  // namespace leafcutter::geometry
