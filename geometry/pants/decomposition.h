// Pants decompositions of a surface, as first maps into their dual trees (section 3.2 and 3.3,
// steps 1 and 2): from the Reeb graph of a function, after cutting along given loops if there are
// any.

#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/pants/tree_word.h"
#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

// A connected surface of negative Euler characteristic, usually a coarse one. Borrows everything
// but the loops.
struct DecompositionSurface {
    std::span<const std::array<int, 3>> triangles;
    std::span<const Eigen::Vector3d> positions;
    const VertexRings& rings;                      // Of the triangles.
    std::span<const double> weights;               // Positive, per edge of the rings.
    std::vector<std::vector<int>> boundary_loops;  // Surface to the left.
    // Simple closed vertex cycles, disjoint from each other and from the boundary, that must be
    // among the decomposition's curves.
    std::vector<std::vector<int>> cuts = {};
};

struct PantsCandidate {
    std::string name;  // Such as "reeb-harmonic".
    // All weights 1; vertices of boundary loops are fixed at the end nodes of their edges.
    GraphMap map;
};

// One candidate for each function that gives a sound graph: trivalent, connected, 2g - 2 + b pants
// and 3g - 3 + 2b edges, b of them ending in boundaries. `attempt` > 0 varies the functions, for
// retries. HandleLoops and TunnelLoops find their own cuts.
//
// Throws Error(BadOption, "loop-not-essential" or "loops-homotopic") for cuts that bound a disk or
// an annulus, and Error(SelfCheck, "pants-graph") if no function gives a sound graph.
std::vector<PantsCandidate> pants_candidates(const DecompositionSurface& surface,
                                             PantsSource source,
                                             SweepFunction function,
                                             int attempt,
                                             const Context& context);

}  // namespace leafcutter::geometry
