// The choice of a decomposition and of its weights, on the coarsest level of a hierarchy.

#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/cell_spread.h"
#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/pants/harmonic_map.h"
#include "geometry/pants/hierarchy.h"

namespace leafcutter::geometry {

// A map of the coarsest level, solved.
struct CoarseMap {
    std::string name;  // Of the function or loops, and of the rule for weights.
    GraphMap map;
    HarmonicMapReport report;
    CellSpread spread;
    double unevenness = 0.0;   // Root mean square of the logarithm of cell area, over the surface.
    double loop_length = 0.0;  // Mean length of the leaves of F in all cylinders together.
    double score = 0.0;        // Of both; less is better.
};

struct CoarseOptions {
    PantsSource pants = PantsSource::Reeb;
    SweepFunction function = SweepFunction::Auto;
    std::optional<std::vector<double>> weights;
    int attempt = 0;  // Later ones start elsewhere.
    // Which solved maps may be taken; empty: all.
    std::function<bool(const GraphMap&)> is_allowed = {};
};

// All that could be solved, best first. With automatic weights each decomposition is tried with the
// lengths of its parts and with equal weights.
// Throws Error(BadOption) for weights of the wrong number, Error(SelfCheck, "none-allowed") if no
// map may be taken, and as pants_candidates does.
std::vector<CoarseMap> solve_coarsest(const Hierarchy& hierarchy,
                                      const CoarseOptions& options,
                                      const Context& context);

// The same map with other weights, one for each graph edge, solved again from where it is. `level`
// is the coarsest.
CoarseMap with_other_weights(const Hierarchy::Level& level,
                             const CoarseMap& start,
                             const std::vector<double>& weights,
                             const Context& context);

}  // namespace leafcutter::geometry
