// Which boundary loops to let the flow of a one-form begin and end at, so that its zeros come near
// to wanted places.

#pragma once

#include <span>
#include <vector>

#include "geometry/cases/one_form.h"
#include "geometry/context.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

// Every loop becomes a source or a sink; those that `given` names stay what they are. On a coarse
// version of the surface f is a sum of one harmonic function for each sink, so that all ways to
// choose are looked at, or with many loops, all that a change of one loop after the other leads to.
// Of equally near ones it is the first. `given` itself if no choice has as many zeros as `near` has
// vertices.
FlowEnds nearest_flow(const TriangleMesh& mesh,
                      const std::vector<std::vector<int>>& loops,
                      const FlowEnds& given,
                      std::span<const int> near,
                      const Context& context);

}  // namespace leafcutter::geometry
