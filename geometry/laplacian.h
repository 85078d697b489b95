// The cotangent Laplacian as a list of weighted edges, and harmonic functions for it.
//
// Functions may be multivalued: `jump[e]` is what the lift of such a function rises along edge e
// more than its vertex values do, so that its difference along e is u(to) - u(from) + jump.
//
// Energies are E(u) = 1/2 sum of w (difference)^2 with w = (cot + cot)/2, that is half the integral
// of the squared gradient (section 3.3; its printed weight lacks the 1/2).

#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/intrinsic_delaunay.h"
#include "geometry/sparse_solver.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

struct WeightedEdge {
    int from = 0;
    int to = 0;
    double weight = 0.0;
    int half_edge = 0;  // Of the triangulation the edge is from; runs from `from` to `to`.
};

// Weights of interior edges are >= 0; a boundary edge's single cotangent may be negative.
std::vector<WeightedEdge> cotangent_edges(const IntrinsicTriangulation& triangulation);

// Cotangent weights of the triangles as they are, forced into a positive interval: any positive
// weights give an embedding in the theorems of Tutte and of Gortler, Gotsman and Thurston.
std::vector<WeightedEdge> positive_edges(const TriangleMesh& mesh,
                                         const HalfEdges& edges,
                                         double least = 0.02);

// Half the sum of weight x difference squared. `jump` has an entry for each edge or is empty.
double dirichlet_energy(std::span<const WeightedEdge> edges,
                        const Eigen::VectorXd& values,
                        std::span<const double> jump = {});

// Largest relative difference between the fluxes of a function through two of its level sets, those
// through whole edges: 0 but for rounding if it is harmonic away from its extreme values.
double flux_variation(std::span<const WeightedEdge> edges, const Eigen::VectorXd& values);

// Functions that are harmonic at every vertex that isn't held. Factors once.
class HarmonicSolver {
public:
    // `held` has an entry for each vertex; at least one is held in each component. Keeps `edges` by
    // reference: they must outlive the solver.
    // Throws Error(SelfCheck, "singular-system") as SparseSolver does.
    HarmonicSolver(std::span<const WeightedEdge> edges, const std::vector<char>& held);

    // Returns `values` with all entries that aren't held replaced.
    // Throws Error(SelfCheck, "singular-system") if the solution isn't finite.
    Eigen::VectorXd solve(Eigen::VectorXd values, std::span<const double> jump = {}) const;

private:
    std::span<const WeightedEdge> edges_;
    std::vector<int> unknown_of_vertex_;  // -1 where held.
    int unknowns_ = 0;
    std::optional<SparseSolver> solver_;
};

}  // namespace leafcutter::geometry
