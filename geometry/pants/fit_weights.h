// Weights of the graph's edges for circumferences in wanted proportions.
//
// The circumference of a cylinder is the derivative of the map's energy by the weight of its edge
// (so that twice the energy is the sum of weight times circumference). Both grow with the scale of
// all weights; only their proportions count.

#pragma once

#include <span>
#include <vector>

#include "geometry/context.h"
#include "geometry/pants/hierarchy.h"
#include "geometry/pants/tree_word.h"

namespace leafcutter::geometry {

// Gives the graph's edges other weights and keeps every vertex at its part of its edge.
void set_weights(GraphMap& map, const std::vector<double>& weights);

std::vector<double> weights_of(const MetricGraph& graph);

// Per graph edge, of a map at its minimum.
std::vector<double> circumferences(const GraphMap& map,
                                   const VertexRings& rings,
                                   std::span<const double> weights);

struct CircumferenceWish {
    std::vector<double> circumferences;  // Per graph edge, > 0; their proportions are wanted.
    std::vector<double> columns;         // How much each counts: an error is a part of so many.
    std::vector<double> weights;         // Of the graph's edges, to stay near:
    double most_change = 0.05;           // no proportion is moved by more than this part or so.
};

// The solved map of a level, solved again with weights that come closest to the wish. Newton's
// method: derivatives by one solve for each edge, then Broyden's updates. Never further off than
// `map`; its mean weight, in logarithms, is kept.
GraphMap fit_weights(const Hierarchy::Level& level,
                     const GraphMap& map,
                     const CircumferenceWish& wish,
                     const Context& context);

}  // namespace leafcutter::geometry
