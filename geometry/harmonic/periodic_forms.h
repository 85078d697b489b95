// Harmonic one-forms with integer periods on a torus, and the charts they make.

#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "geometry/harmonic/chart_map.h"
#include "geometry/harmonic/resolve.h"
#include "geometry/laplacian.h"
#include "geometry/loops/tree_cotree.h"

namespace leafcutter::geometry {

// An integer combination of two basis forms.
using FormClass = Eigen::Vector2i;

// Harmonic representatives of a basis of the integer cohomology, and their inner products.
struct HarmonicForms {
    std::array<Eigen::VectorXd, 2> values;  // Per vertex.
    std::array<Cochain, 2> jump;            // On the half-edges of the surface as given.
    Eigen::Matrix2d gram;  // Twice the Dirichlet inner product; determinant 1 if exact.

    double product(const FormClass& a, const FormClass& b) const {
        return a.cast<double>().dot(gram * b.cast<double>());
    }
};

// What a combination rises more along each edge, from the basis cochains there.
std::vector<double> jumps_of(const FormClass& combination, std::span<const Jump> jump);

// Gauss reduction: the shortest class first, then the shortest independent of it, with
// 2 |<a, b>| <= <a, a> <= <b, b>.
std::pair<FormClass, FormClass> shortest_classes(const HarmonicForms& forms);

// Sets the coordinates of solved.map, of height 1, and the bounds of its modulus: f is the integral
// of the first form, `rising`; g its conjugate, which rises by `width` where the second, `round`,
// rises by 1 and f doesn't. Returns the matrix that takes the values of the basis forms to (g, f).
Eigen::Matrix2d lay_out_torus(SolvedChart& solved,
                              const HarmonicForms& forms,
                              const std::pair<FormClass, FormClass>& rising_and_round);

// Largest relative difference of the fluxes through two leaves of a function that is harmonic but
// for whole numbers: its values per vertex, and what it rises more along each edge.
double periodic_flux_variation(std::span<const WeightedEdge> edges,
                               const Eigen::VectorXd& values,
                               std::span<const double> jump);

}  // namespace leafcutter::geometry
