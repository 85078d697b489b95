#include "geometry/cases/disk.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "geometry/cases/corners.h"
#include "geometry/cases/finish.h"
#include "geometry/harmonic/resolve.h"
#include "geometry/laplacian.h"

namespace leafcutter::geometry {
namespace {

// Vertices of the four sides, each from corner to corner, counter-clockwise: bottom (f = 0), right
// (g = width), top (f = height), left (g = 0).
using Sides = std::array<std::vector<int>, 4>;
enum Side : std::size_t { Bottom, Right, Top, Left };

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

Sides cut_sides(std::span<const int> loop, const LoopCorners& corners) {
    Sides sides;
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t end = at(corners[(k + 1) % 4]);
        std::size_t i = at(corners[k]);
        for (; i != end; i = (i + 1) % loop.size()) {
            sides[k].push_back(loop[i]);
        }
        sides[k].push_back(loop[end]);
    }
    return sides;
}

// The corner that the bottom side starts from: f is to rise along the longer pair of sides.
std::size_t first_corner(const std::vector<double>& arc, const LoopCorners& corners) {
    std::array<double, 4> length{};
    for (std::size_t k = 0; k < 4; ++k) {
        const double end = arc[at(corners[(k + 1) % 4])] + (k == 3 ? arc.back() : 0.0);
        length[k] = end - arc[at(corners[k])];
    }
    // Pairs that differ by rounding count as equal.
    return length[0] + length[2] > (length[1] + length[3]) * (1.0 + 1e-9) ? 1 : 0;
}

std::vector<std::uint8_t> lines_of_vertices(const Sides& sides, std::size_t vertices) {
    std::vector<std::uint8_t> lines(vertices, 0);
    for (std::size_t k = 0; k < 4; ++k) {
        for (const int v : sides[k]) {
            lines[at(v)] = static_cast<std::uint8_t>(lines[at(v)] | (1U << k));
        }
    }
    return lines;
}

// The harmonic function that is 0 on side `zero`, 1 on side `one`.
Eigen::VectorXd between_sides(const std::vector<WeightedEdge>& edges,
                              const std::vector<std::uint8_t>& lines,
                              std::pair<Side, Side> zero_and_one) {
    const auto n = static_cast<Eigen::Index>(lines.size());
    std::vector<char> held(lines.size(), 0);
    Eigen::VectorXd values = Eigen::VectorXd::Zero(n);
    for (std::size_t v = 0; v < lines.size(); ++v) {
        const bool zero = ((lines[v] >> zero_and_one.first) & 1U) != 0;
        const bool one = ((lines[v] >> zero_and_one.second) & 1U) != 0;
        held[v] = zero || one ? 1 : 0;
        values[static_cast<Eigen::Index>(v)] = one ? 1.0 : 0.0;
    }
    return HarmonicSolver(edges, held).solve(std::move(values));
}

SolvedChart solve_rectangle(const ChartSurface& surface) {
    SolvedChart solved;
    ChartMap& map = solved.map;
    map = start_chart(surface);
    const std::vector<WeightedEdge> edges =
        cotangent_edges(intrinsic_delaunay(map.mesh, map.edges));
    const Eigen::VectorXd f = between_sides(edges, surface.lines, {Bottom, Top});
    const Eigen::VectorXd g = between_sides(edges, surface.lines, {Left, Right});
    // Both energies bound the modulus, one from above, one from below; their geometric mean is much
    // closer to it.
    solved.upper = 2.0 * dirichlet_energy(edges, f);
    solved.lower = 1.0 / (2.0 * dirichlet_energy(edges, g));
    solved.flux_mismatch = flux_variation(edges, f);
    map.shape = ChartShape::Rectangle;
    map.height = 1.0;
    map.width = std::sqrt(solved.upper * solved.lower);
    for (std::size_t v = 0; v < map.gf.size(); ++v) {
        const auto i = static_cast<Eigen::Index>(v);
        map.gf[v] = {map.width * g[i], f[i]};
    }
    return solved;
}

std::vector<Rail> rails_between(const HalfEdges& edges, const std::array<int, 4>& corners) {
    std::vector<Rail> rails;
    for (std::size_t k = 0; k < 4; ++k) {
        Rail rail{boundary_path(edges, corners[k], corners[(k + 1) % 4]), k % 2 == 0 ? 0 : 1,
                  false};
        if (k == Top || k == Left) {
            std::reverse(rail.vertices.begin(), rail.vertices.end());
        }
        rails.push_back(std::move(rail));
    }
    return rails;
}

}  // namespace

Foliation foliate_disk(const TriangleMesh& mesh,
                       std::span<const int> loop,
                       const FoliationOptions& options,
                       const Context& context) {
    if (loop.size() < 4) {
        throw Error(ErrorKind::BadMesh, "boundary-too-short",
                    "the boundary has " + std::to_string(loop.size()) +
                        " vertices, four corners need four; refine the mesh");
    }
    const LoopCorners chosen =
        options.corners ? locate_corners(loop, *options.corners) : choose_corners(mesh, loop);
    const std::size_t first = first_corner(arc_lengths(mesh, loop), chosen);
    return foliate_rectangle(
        mesh, loop,
        {chosen[first], chosen[(first + 1) % 4], chosen[(first + 2) % 4], chosen[(first + 3) % 4]},
        options, context);
}

Foliation foliate_rectangle(const TriangleMesh& mesh,
                            std::span<const int> loop,
                            const LoopCorners& corner_places,
                            const FoliationOptions& options,
                            const Context& context) {
    const Sides sides = cut_sides(loop, corner_places);
    const std::array<int, 4> corners{sides[Bottom].front(), sides[Right].front(),
                                     sides[Top].front(), sides[Left].front()};
    SolvedChart solved =
        solve_resolved(start_surface(mesh, lines_of_vertices(sides, mesh.positions.size())),
                       solve_rectangle, options.refinement, context);
    const std::vector<Rail> rails = rails_between(solved.map.edges, corners);
    Foliation foliation = finish_foliation(std::move(solved), rails, context);
    foliation.mode = FoliationMode::Disk;
    foliation.graph = {2, {{0, 1, 1.0}}};
    foliation.corners = corners;
    return foliation;
}

}  // namespace leafcutter::geometry
