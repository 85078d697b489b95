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

// Values of a function that are given.
struct HeldValues {
    std::vector<char> held;
    Eigen::VectorXd values;
};

// 0 on side `zero`, 1 on side `one`.
HeldValues between_sides(const std::vector<std::uint8_t>& lines,
                         std::pair<Side, Side> zero_and_one) {
    HeldValues out{std::vector<char>(lines.size(), 0),
                   Eigen::VectorXd::Zero(static_cast<Eigen::Index>(lines.size()))};
    for (std::size_t v = 0; v < lines.size(); ++v) {
        const bool zero = ((lines[v] >> zero_and_one.first) & 1U) != 0;
        const bool one = ((lines[v] >> zero_and_one.second) & 1U) != 0;
        out.held[v] = zero || one ? 1 : 0;
        out.values[static_cast<Eigen::Index>(v)] = one ? 1.0 : 0.0;
    }
    return out;
}

// What is to hold at the sides of f, beyond its values at the ends.
struct HeldSides {
    std::array<int, 4> corners{};    // Vertices.
    std::span<const double> values;  // Per vertex of the surface as given, or empty.
};

// Holds f along one side at the given values, linear between the given vertices.
void hold_side(HeldValues& f,
               const ChartSurface& surface,
               const std::vector<int>& path,
               std::span<const double> values) {
    const auto position = [&](std::size_t i) -> const Eigen::Vector3d& {
        return surface.mesh.positions[at(path[i])];
    };
    for (std::size_t i = 0; i + 1 < path.size();) {
        std::size_t end = i + 1;
        while (surface.source_vertex[at(path[end])] < 0) {
            ++end;
        }
        const double first = values[at(surface.source_vertex[at(path[i])])];
        const double last = values[at(surface.source_vertex[at(path[end])])];
        const double length = (position(end) - position(i)).norm();
        for (std::size_t k = i + 1; k < end; ++k) {
            const double part = length > 0.0 ? (position(k) - position(i)).norm() / length : 0.5;
            f.held[at(path[k])] = 1;
            f.values[path[k]] = first + part * (last - first);
        }
        if (end + 1 < path.size()) {
            f.held[at(path[end])] = 1;
            f.values[path[end]] = last;
        }
        i = end;
    }
}

SolvedChart solve_rectangle(const ChartSurface& surface, const HeldSides& sides) {
    SolvedChart solved;
    ChartMap& map = solved.map;
    map = start_chart(surface);
    const std::vector<WeightedEdge> edges =
        cotangent_edges(intrinsic_delaunay(map.mesh, map.edges));
    HeldValues held = between_sides(surface.lines, {Bottom, Top});
    if (!sides.values.empty()) {
        for (const std::size_t side : {Right, Left}) {
            hold_side(held, surface,
                      boundary_path(map.edges, sides.corners[side], sides.corners[(side + 1) % 4]),
                      sides.values);
        }
    }
    const auto solve = [&](HeldValues given) {
        return HarmonicSolver(edges, given.held).solve(std::move(given.values));
    };
    const Eigen::VectorXd f = solve(std::move(held));
    const Eigen::VectorXd g = solve(between_sides(surface.lines, {Left, Right}));
    // Both energies bound the modulus, one from above, one from below; their geometric mean is much
    // closer to it.
    solved.upper = 2.0 * dirichlet_energy(edges, f);
    solved.lower = 1.0 / (2.0 * dirichlet_energy(edges, g));
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

// Gives `map` the f that its sides are to have, unless triangles would be flipped then beyond local
// repair. Returns whether it did.
bool hold_sides(ChartMap& map,
                const ChartSurface& surface,
                const HeldSides& sides,
                const std::vector<Rail>& rails,
                const Context& context) {
    ChartMap held = map;
    const ChartMap solved = solve_rectangle(surface, sides).map;
    for (std::size_t v = 0; v < held.gf.size(); ++v) {
        held.gf[v].y() = solved.gf[v].y();
    }
    const FlipReport repair = make_bijective(held, rails, context);
    if (repair.whole_chart || repair.opened_limbs || !bad_triangles(held).empty()) {
        return false;
    }
    map = std::move(held);
    return true;
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
        mesh,
        {loop,
         {chosen[first], chosen[(first + 1) % 4], chosen[(first + 2) % 4], chosen[(first + 3) % 4]},
         {}},
        options, context);
}

Foliation foliate_rectangle(const TriangleMesh& mesh,
                            const RectangleBorder& border,
                            const FoliationOptions& options,
                            const Context& context) {
    const Sides sides = cut_sides(border.loop, border.corners);
    const std::array<int, 4> corners{sides[Bottom].front(), sides[Right].front(),
                                     sides[Top].front(), sides[Left].front()};
    ChartSurface surface;
    SolvedChart solved = solve_resolved(
        start_surface(mesh, lines_of_vertices(sides, mesh.positions.size())),
        [&surface](const ChartSurface& finer) {
            surface = finer;
            return solve_rectangle(surface, {});
        },
        options.refinement, context);
    const std::vector<Rail> rails = rails_between(solved.map.edges, corners);
    const bool met =
        border.f.empty() || hold_sides(solved.map, surface, {corners, border.f}, rails, context);
    Foliation foliation = finish_foliation(std::move(solved), rails, context);
    if (!met) {
        foliation.warnings.emplace_back(
            "it is so narrow or so coarse that its rows can't meet those of its neighbours");
    }
    foliation.mode = FoliationMode::Disk;
    foliation.graph = {2, {{0, 1, 1.0}}};
    foliation.corners = corners;
    return foliation;
}

}  // namespace leafcutter::geometry
