// The linear system of one Newton step of the harmonic map: its energy is quadratic as long as no
// vertex passes a node.
//
// One factorization serves many steps. When a vertex passes a node the signs of its row change; up
// to the few edges near three-prong points the matrix is then conjugated with a diagonal of signs,
// the gauge. Conjugate gradients, preconditioned by the old factor in the new gauge, do the rest.

#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/context.h"
#include "geometry/pants/local_step.h"
#include "geometry/pants/tree_word.h"
#include "geometry/pants/vertex_rings.h"
#include "geometry/sparse_solver.h"

namespace leafcutter::geometry {

class FrozenSystem {
public:
    // Keeps references to the rings and weights.
    FrozenSystem(const VertexRings& rings, std::span<const double> weights, std::size_t vertices);

    // By how much to move the vertices that are `active` so that the energy is least with all words
    // as they are; zero for others. `gauge` is changed only when the matrix is factored anew: then
    // all of it is set to 1.
    Eigen::VectorXd newton_direction(const GraphMap& map,
                                     std::span<const char> active,
                                     std::vector<signed char>& gauge,
                                     const Context& context);

    int factorizations() const { return factorizations_; }
    int solves() const { return solves_; }

private:
    struct Term {  // w (constant - from_sign t_from + to_sign t_to)^2
        double weight = 0.0;
        signed char sign = 0;  // Product of both; 0 if one end is not active.
    };

    Eigen::VectorXd freeze(const GraphMap& map, std::span<const char> active);
    void factor();
    void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;
    Eigen::VectorXd precondition(const Eigen::VectorXd& r, const std::vector<signed char>& gauge);
    bool iterate(Eigen::VectorXd& x,
                 const Eigen::VectorXd& right,
                 const std::vector<signed char>& gauge,
                 const Context& context);

    const VertexRings& rings_;
    std::span<const double> weights_;
    std::vector<Term> terms_;       // Per mesh edge.
    std::vector<double> diagonal_;  // Per vertex.
    std::vector<int> place_;        // Per mesh edge: of its entry in matrix_.
    SymmetricMatrix matrix_;
    std::optional<SparseSolver> factor_;
    int factorizations_ = 0;
    int solves_ = 0;
    int solves_with_factor_ = 0;
};

}  // namespace leafcutter::geometry
