#include "geometry/cases/sphere_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "geometry/cases/sphere_cover.h"
#include "geometry/cell_spread.h"
#include "geometry/coarse_version.h"
#include "geometry/error.h"
#include "geometry/limb_tips.h"
#include "geometry/parallel.h"

namespace leafcutter::geometry {
namespace {

constexpr std::size_t kCoarseVertices = 3500;
constexpr std::size_t kCandidates = 8;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// The coarse surface as an intrinsic triangulation, on which any four points can be tried.
struct TrialSurface {
    IntrinsicTriangulation delaunay;
    std::vector<double> weight;  // Per half-edge, of its edge.
    std::vector<double> area;    // Per triangle.
};

TrialSurface trial_surface(const TriangleMesh& mesh) {
    TrialSurface out;
    out.delaunay = intrinsic_delaunay(
        mesh, build_half_edges(mesh.triangles, static_cast<int>(mesh.positions.size())));
    out.weight.resize(out.delaunay.length.size());
    for (const WeightedEdge& edge : cotangent_edges(out.delaunay)) {
        out.weight[at(edge.half_edge)] = edge.weight;
        out.weight[at(out.delaunay.edges.twin_of(edge.half_edge))] = edge.weight;
    }
    for (int h = 0; h < out.delaunay.edges.size(); h += 3) {
        const double a = out.delaunay.length[at(h)];
        const double b = out.delaunay.length[at(h + 1)];
        const double c = out.delaunay.length[at(h + 2)];
        const double product = (a + b + c) * (a + b - c) * (b + c - a) * (c + a - b);
        out.area.push_back(0.25 * std::sqrt(std::max(product, 0.0)));
    }
    return out;
}

// Area of each triangle in the flat metric, up to one factor: |d form|^2 in the metric that the
// Gram matrix gives to forms. Never negative, however coarse the surface.
double flat_area(const TrialSurface& surface,
                 const HarmonicForms& forms,
                 const Eigen::Matrix2d& inverse_gram,
                 const BranchedCover& cover,
                 int triangle) {
    double flat = 0.0;
    for (int h = 3 * triangle; h < 3 * triangle + 3; ++h) {
        Eigen::Vector2d rise;
        for (std::size_t k = 0; k < 2; ++k) {
            rise[static_cast<Eigen::Index>(k)] = forms.values[k][cover.edges.to_of(h)] -
                                                 forms.values[k][cover.edges.from_of(h)] +
                                                 forms.jump[k][at(h)];
        }
        flat += 0.5 * facing_cotangent(surface.delaunay, h) * rise.dot(inverse_gram * rise);
    }
    return flat;
}

CellSpread spread_for(const TrialSurface& surface, const std::array<int, 4>& points) {
    const BranchedCover cover =
        branched_cover(surface.delaunay.edges, surface.delaunay.vertex_count, points);
    const OddCochains cochains = odd_cochains(cover, points[0]);
    std::vector<WeightedEdge> edges;
    std::vector<Jump> jump;
    const int half = cover.edges.size() / 2;
    for (int h = 0; h < cover.edges.size(); ++h) {
        if (cover.edges.is_first(h)) {
            edges.push_back(
                {cover.edges.from_of(h), cover.edges.to_of(h), surface.weight[at(h % half)], h});
            jump.push_back({cochains.jump[0][at(h)], cochains.jump[1][at(h)]});
        }
    }
    const HarmonicForms forms = solve_odd_forms(cover, cochains, edges, jump);
    const Eigen::Matrix2d inverse_gram = forms.gram.inverse();
    std::vector<FlatArea> parts;
    for (std::size_t t = 0; t < surface.area.size(); ++t) {
        parts.push_back(
            {surface.area[t], flat_area(surface, forms, inverse_gram, cover, static_cast<int>(t))});
    }
    return cell_spread(parts);
}

// First `wanted`, then tips of limbs, then what is far from all of them.
std::vector<int> candidates(const TriangleMesh& mesh,
                            const std::vector<int>& wanted,
                            const Context& context) {
    std::vector<int> out = wanted;
    for (const LimbTip& tip : find_limb_tips(mesh, {}, context)) {
        if (out.size() < kCandidates &&
            std::find(out.begin(), out.end(), tip.vertex) == out.end()) {
            out.push_back(tip.vertex);
        }
    }
    for (const int vertex : farthest_vertices(mesh, out, kCandidates - out.size(), context)) {
        out.push_back(vertex);
    }
    return out;
}

// All choices of four that begin with the first `kept`.
std::vector<std::array<int, 4>> subsets(const std::vector<int>& of, std::size_t kept) {
    std::vector<std::array<int, 4>> out;
    const std::size_t n = of.size();
    for (std::size_t a = 0; a < n; ++a) {
        for (std::size_t b = a + 1; b < n; ++b) {
            for (std::size_t c = b + 1; c < n; ++c) {
                for (std::size_t d = c + 1; d < n; ++d) {
                    const std::array<std::size_t, 4> places{a, b, c, d};
                    if (kept == 0 || places[kept - 1] == kept - 1) {
                        out.push_back({of[a], of[b], of[c], of[d]});
                    }
                }
            }
        }
    }
    return out;
}

// The vertices of a coarse version that come nearest, no two alike.
std::vector<int> nearest_vertices(const CoarseVersion& coarse,
                                  const TriangleMesh& mesh,
                                  std::span<const int> wanted) {
    std::vector<int> out;
    for (const int vertex : wanted) {
        int nearest = -1;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t v = 0; v < coarse.mesh.positions.size(); ++v) {
            const double square =
                (coarse.mesh.positions[v] - mesh.positions[at(vertex)]).squaredNorm();
            const bool is_free =
                std::find(out.begin(), out.end(), static_cast<int>(v)) == out.end();
            if (is_free && square < least) {
                least = square;
                nearest = static_cast<int>(v);
            }
        }
        out.push_back(nearest);
    }
    return out;
}

}  // namespace

std::array<int, 4> choose_pillow_points(const TriangleMesh& mesh,
                                        std::span<const int> wanted,
                                        const Context& context) {
    const CoarseVersion coarse = coarse_version(mesh, kCoarseVertices, context);
    if (coarse.mesh.positions.size() < 4) {
        throw Error(ErrorKind::BadMesh, "too-few-vertices",
                    "a pillowcase needs four vertices; refine the model");
    }
    const TrialSurface surface = trial_surface(coarse.mesh);
    const std::vector<std::array<int, 4>> choices = subsets(
        candidates(coarse.mesh, nearest_vertices(coarse, mesh, wanted), context), wanted.size());
    std::vector<double> variation(choices.size(), std::numeric_limits<double>::infinity());
    for_each_task(choices.size(), context, [&](std::size_t i, const Context& /*own*/) {
        try {
            variation[i] = spread_for(surface, choices[i]).variation;
        } catch (const Error&) {
            // Points for which the system is singular are no choice.
        }
    });
    if (choices.empty()) {
        throw Error(ErrorKind::BadMesh, "too-few-vertices",
                    "a pillowcase needs four vertices; refine the model");
    }
    const auto best = std::min_element(variation.begin(), variation.end());
    std::array<int, 4> points = choices[static_cast<std::size_t>(best - variation.begin())];
    for (int& point : points) {
        point = coarse.source_vertex[at(point)];
    }
    std::copy(wanted.begin(), wanted.end(), points.begin());
    return points;
}

}  // namespace leafcutter::geometry
