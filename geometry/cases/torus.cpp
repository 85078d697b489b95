#include "geometry/cases/torus.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "geometry/cases/finish.h"
#include "geometry/harmonic/periodic_forms.h"
#include "geometry/harmonic/resolve.h"
#include "geometry/laplacian.h"
#include "geometry/loops/tree_cotree.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

struct TorusForms {
    HarmonicForms forms;
    std::vector<WeightedEdge> edges;  // Of the intrinsic Delaunay triangulation.
    std::vector<Jump> jump;           // Per edge.
};

TorusForms solve_forms(const ChartMap& map) {
    TorusForms out;
    HarmonicForms& forms = out.forms;
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
    out.edges = cotangent_edges(delaunay);
    for (const WeightedEdge& edge : out.edges) {
        out.jump.push_back(delaunay.jump[at(edge.half_edge)]);
    }
    std::vector<char> held(map.gf.size(), 0);
    held.front() = 1;
    const HarmonicSolver solver(out.edges, held);
    const std::array<std::vector<double>, 2> edge_jump{jumps_of({1, 0}, out.jump),
                                                       jumps_of({0, 1}, out.jump)};
    for (std::size_t k = 0; k < 2; ++k) {
        forms.values[k] = solver.solve(
            Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size())), edge_jump[k]);
    }
    forms.gram.setZero();
    for (std::size_t e = 0; e < out.edges.size(); ++e) {
        const WeightedEdge& edge = out.edges[e];
        const auto rise = [&](std::size_t k) {
            return forms.values[k][edge.to] - forms.values[k][edge.from] + edge_jump[k][e];
        };
        const Eigen::Vector2d both(rise(0), rise(1));
        forms.gram += edge.weight * both * both.transpose();
    }
    return out;
}

SolvedChart solve_torus(const ChartSurface& surface, TorusRings rings) {
    SolvedChart solved;
    solved.map = start_chart(surface);
    const TorusForms solution = solve_forms(solved.map);
    const HarmonicForms& forms = solution.forms;
    // The form of least energy rises along the long generator: its level sets are the short rings.
    auto [rising, round] = shortest_classes(forms);
    if (rings == TorusRings::Long) {
        std::swap(rising, round);
    }
    lay_out_torus(solved, forms, {rising, round});
    solved.flux_mismatch = periodic_flux_variation(
        solution.edges, rising.x() * forms.values[0] + rising.y() * forms.values[1],
        jumps_of(rising, solution.jump));
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
