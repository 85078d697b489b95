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

SolvedChart solve_torus(const ChartSurface& surface, TorusRings rings) {
    SolvedChart solved;
    solved.map = start_chart(surface);
    const HarmonicForms forms = solve_forms(solved.map);
    // The form of least energy rises along the long generator: its level sets are the short rings.
    auto [rising, round] = shortest_classes(forms);
    if (rings == TorusRings::Long) {
        std::swap(rising, round);
    }
    lay_out_torus(solved, forms, {rising, round});
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
