// Algorithm 1 of the paper (section 3.3): moves one vertex after another to the weighted geodesic
// centre of its neighbours until the energy hardly falls any more.
//
// Slow, in proportion to the squared number of vertices and more: the reference that
// solve_harmonic_map is measured against.

#pragma once

#include <span>
#include <vector>

#include "geometry/context.h"
#include "geometry/pants/tree_word.h"
#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

enum class TargetDistance {
    Tree,   // In the dual tree: a homotopy class has one minimum, all its cylinders sound.
    Graph,  // Shortest path in the graph, as printed. Words are neither read nor kept.
};

struct HeatFlowOptions {
    TargetDistance distance = TargetDistance::Tree;
    double tolerance = 1e-12;  // Ends when a sweep lowers the energy by less than this part of it.
    int most_sweeps = 100'000;
};

struct HeatFlowReport {
    std::vector<double> energies;  // At the start and after every sweep, none larger than the last.
    double residual = 0.0;         // Largest move of a vertex in the last sweep, by the longest
                                   // edge of the graph.
    bool converged = false;        // Else it ran out of sweeps.

    int sweeps() const { return static_cast<int>(energies.size()) - 1; }
    double energy() const { return energies.back(); }
};

// 1/2 sum of weight x squared distance in the graph.
double graph_distance_energy(const GraphMap& map,
                             const VertexRings& rings,
                             std::span<const double> weights);

// Improves `map`. `weights` are per mesh edge and positive. Throws Cancelled.
HeatFlowReport heat_flow(GraphMap& map,
                         const VertexRings& rings,
                         std::span<const double> weights,
                         const HeatFlowOptions& options,
                         const Context& context);

}  // namespace leafcutter::geometry
