// A surface between sources and sinks: f is a harmonic function, (g, f) the integral of a
// holomorphic one-form (section 2.1). Cut along the leaves of F* through its zeros the surface
// falls into rectangles that all run from a source, f = 0, to a sink, f = 1.

#pragma once

#include <vector>

#include "geometry/foliation.h"

namespace leafcutter::geometry {

// Boundary loops, by their numbers.
struct FlowEnds {
    std::vector<int> sources;
    std::vector<int> sinks;
};

// `ends` index into `loops`, all boundary loops of the connected `mesh`, surface to
// the left. Loops named in neither are natural: no flux passes them, they are leaves of F*.
//
// The cylinders are rectangles of height 1, or one annulus for a surface without zeros; their f
// agree along shared sides but for the accuracy of the mesh, and their widths add up to the flux.
// Singularities are the zeros inside the surface: 4 prongs, or 2 more for each further zero that
// the mesh can't tell from the first. Lines of critical_graph run from zeros to loops.
//
// Throws Error(BadOption, "bad-sources" or "bad-sinks") unless both are named, in range and
// disjoint, Error(SelfCheck, "one-form") naming the stage where a result fails its check, and as
// compute_foliation does.
Foliation foliate_one_form(const TriangleMesh& mesh,
                           const std::vector<std::vector<int>>& loops,
                           const FlowEnds& ends,
                           const FoliationOptions& options,
                           const Context& context);

}  // namespace leafcutter::geometry
