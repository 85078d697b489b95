// Weaves a surface in the computer from nothing but lengths measured on its strips.

#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "fab/strips/strip.h"
#include "geometry/context.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

// The distance of two vertices of the mesh, as a strip of one family brings it.
struct MeasuredLength {
    int from = 0;
    int to = 0;
    double mm = 0.0;
    Family family = Family::Weft;
};

// The vertices whose distances fit `lengths` best in the sense of least squares, starting from
// `plan`, by Levenberg and Marquardt.
//
// Lengths alone do not tell everything: a surface may be moved as a whole, and bent a little in
// ways that change lengths hardly at all. Every vertex is therefore held at its place in the plan
// by a spring of (mean edge / diagonal)² of the stiffness of a length. What changes lengths by a
// smaller part than it moves vertices in diagonals is left to the plan: a scale is seen in full, a
// bend without stretch is not.
std::vector<Eigen::Vector3d> weave_virtually(const geometry::QuadMesh& plan,
                                             std::span<const MeasuredLength> lengths,
                                             const geometry::Context& context = {});

// Of the box round the vertices, in mm; 0 for none.
double diagonal_of(const std::vector<Eigen::Vector3d>& vertices);

// The largest difference between what weft and warp say of the same length.
double largest_disagreement_mm(std::vector<MeasuredLength> lengths);

}  // namespace leafcutter::fab
