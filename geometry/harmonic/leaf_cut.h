// Cuts a surface along the leaves of F* through the zeros of a one-form.
//
// A leaf is a level set of g, followed from triangle to triangle by the differences of g alone,
// never by integrating a gradient: two leaves of one closed form can't cross, whatever the mesh.
// Every crossing of an edge becomes a vertex, so that leaves are chains of edges.

#pragma once

#include <vector>

#include "geometry/context.h"
#include "geometry/harmonic/conjugate_form.h"
#include "geometry/harmonic/form_zeros.h"

namespace leafcutter::geometry {

struct CutSurface {
    ChartSurface surface;
    std::vector<double> f;     // Per vertex.
    std::vector<double> rise;  // Of g, per half-edge; 0 along leaves.
    std::vector<char> cut;     // Per half-edge, the same for both of an edge.
    std::vector<FormZero> zeros;
    double worst_turn = 0.0;  // By how much f goes back along a leaf, at most.
};

// Throws Error(SelfCheck, "one-form") if a leaf doesn't reach a source or sink, or if neighbouring
// leaves of a zero go the same way.
CutSurface cut_along_leaves(ChartSurface surface,
                            const ConjugateForm& form,
                            const std::vector<FormZero>& zeros,
                            const Context& context);

// The leaves that are cut, each from a zero to a loop or to another zero.
std::vector<std::vector<Eigen::Vector3d>> cut_lines(const CutSurface& cut);

}  // namespace leafcutter::geometry
