#include "geometry/cases/torus.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "geometry/cases/finish.h"
#include "geometry/harmonic/resolve.h"
#include "geometry/laplacian.h"
#include "geometry/loops/tree_cotree.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// A harmonic form with integer periods: an integer combination of the two basis forms.
using Class = Eigen::Vector2i;

// Harmonic representatives of a basis of the integer cohomology, and their inner products.
struct HarmonicForms {
    std::array<Eigen::VectorXd, 2> values;
    std::array<Cochain, 2> jump;  // On the half-edges of the surface as given.
    Eigen::Matrix2d gram;         // Twice the Dirichlet inner product; determinant 1 if exact.

    double product(const Class& a, const Class& b) const {
        return a.cast<double>().dot(gram * b.cast<double>());
    }
};

HarmonicForms solve_forms(const ChartMap& map) {
    HarmonicForms forms;
    std::vector<Cochain> basis =
        cohomology_basis(map.edges, static_cast<int>(map.mesh.positions.size()));
    if (basis.size() != 2) {
        throw Error(ErrorKind::SelfCheck, "not-a-torus",
                    "the torus case was given a surface with " + std::to_string(basis.size()) +
                        " independent loops instead of 2");
    }
    forms.jump = {std::move(basis[0]), std::move(basis[1])};
    std::vector<Jump> jump(forms.jump[0].size());
    for (std::size_t h = 0; h < jump.size(); ++h) {
        jump[h] = {forms.jump[0][h], forms.jump[1][h]};
    }
    const IntrinsicTriangulation delaunay = intrinsic_delaunay(map.mesh, map.edges, jump);
    const std::vector<WeightedEdge> edges = cotangent_edges(delaunay);

    std::vector<char> held(map.gf.size(), 0);
    held.front() = 1;
    const HarmonicSolver solver(edges, held);
    std::array<std::vector<double>, 2> rise;
    for (std::size_t k = 0; k < 2; ++k) {
        std::vector<double> edge_jump;
        edge_jump.reserve(edges.size());
        for (const WeightedEdge& edge : edges) {
            edge_jump.push_back(delaunay.jump[at(edge.half_edge)][k]);
        }
        forms.values[k] =
            solver.solve(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size())), edge_jump);
        for (std::size_t e = 0; e < edges.size(); ++e) {
            rise[k].push_back(forms.values[k][edges[e].to] - forms.values[k][edges[e].from] +
                              edge_jump[e]);
        }
    }
    forms.gram.setZero();
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const Eigen::Vector2d both(rise[0][e], rise[1][e]);
        forms.gram += edges[e].weight * both * both.transpose();
    }
    return forms;
}

// Gauss reduction: the shortest class first, then the shortest independent of it, with
// 2 |<a, b>| <= <a, a> <= <b, b>.
std::pair<Class, Class> shortest_classes(const HarmonicForms& forms) {
    Class a(1, 0);
    Class b(0, 1);
    // Each round shortens b; rounding could only stall it at equal lengths.
    for (int round = 0; round < 64; ++round) {
        if (forms.product(b, b) < forms.product(a, a)) {
            std::swap(a, b);
        }
        const double ratio = forms.product(a, b) / forms.product(a, a);
        const int times = static_cast<int>(std::lround(ratio));
        if (times == 0 || std::abs(ratio) <= 0.5 * (1.0 + 1e-12)) {
            break;
        }
        b -= times * a;
    }
    return {a, b};
}

// f = the integral of `rising`; g = width (the integral of `round` less its part along `rising`),
// which is the conjugate: harmonic, orthogonal to f, constant once round the leaves of f but for
// `width`.
void set_coordinates(ChartMap& map,
                     const HarmonicForms& forms,
                     const Class& rising,
                     const Class& round) {
    const double slope = forms.product(rising, round) / forms.product(rising, rising);
    const Eigen::Vector2d f_of = rising.cast<double>();
    const auto set = [&](double scale) {
        const Eigen::Vector2d g_of = scale * (round.cast<double>() - slope * f_of);
        for (std::size_t v = 0; v < map.gf.size(); ++v) {
            const auto i = static_cast<Eigen::Index>(v);
            const Eigen::Vector2d values(forms.values[0][i], forms.values[1][i]);
            map.gf[v] = {g_of.dot(values), f_of.dot(values)};
        }
        for (std::size_t h = 0; h < map.jump.size(); ++h) {
            const Eigen::Vector2d jump(forms.jump[0][h], forms.jump[1][h]);
            map.jump[h] = {g_of.dot(jump), f_of.dot(jump)};
        }
        map.shear = -scale * slope;
    };
    map.jump.resize(forms.jump[0].size());
    set(map.width);
    if (chart_area(map) < 0.0) {
        set(-map.width);
    }
}

SolvedChart solve_torus(const ChartSurface& surface, TorusRings rings) {
    SolvedChart solved;
    ChartMap& map = solved.map;
    map = start_chart(surface);
    const HarmonicForms forms = solve_forms(map);
    // The form of least energy rises along the long generator: its level sets are the short rings.
    auto [rising, round] = shortest_classes(forms);
    if (rings == TorusRings::Long) {
        std::swap(rising, round);
    }
    // Riemann's bilinear relation: the determinant is 1 for harmonic forms, and it is the ratio of
    // the bounds that f and g give for the modulus.
    const double determinant = forms.gram.determinant();
    solved.upper = forms.product(rising, rising);
    solved.lower = solved.upper / determinant;
    map.shape = ChartShape::Torus;
    map.height = 1.0;
    map.width = solved.upper / std::sqrt(determinant);
    set_coordinates(map, forms, rising, round);
    return solved;
}

}  // namespace

Foliation foliate_torus(const TriangleMesh& mesh,
                        const FoliationOptions& options,
                        const Context& context) {
    const TorusRings rings = options.torus_rings;
    SolvedChart solved = solve_resolved(
        start_surface(mesh, std::vector<std::uint8_t>(mesh.positions.size(), 0)),
        [rings](const ChartSurface& surface) { return solve_torus(surface, rings); },
        options.refinement, context);
    Foliation foliation = finish_foliation(std::move(solved), {}, context);
    foliation.mode = FoliationMode::Torus;
    foliation.graph = {1, {{0, 0, 1.0}}};
    return foliation;
}

}  // namespace leafcutter::geometry
