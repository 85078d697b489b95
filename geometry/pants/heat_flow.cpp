#include "geometry/pants/heat_flow.h"

#include <algorithm>
#include <cstddef>
#include <functional>

#include "geometry/pants/graph_metric.h"
#include "geometry/pants/harmonic_map.h"
#include "geometry/pants/local_step.h"

namespace leafcutter::geometry {
namespace {

// Vertices between two looks at the stop request.
constexpr int kVerticesPerCheck = 20'000;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

GraphPoint point_of(const GraphMap& map, int v) {
    return {map.graph_edge[at(v)], map.t[at(v)]};
}

double energy_in_graph(const GraphMetric& metric,
                       const GraphMap& map,
                       const VertexRings& rings,
                       std::span<const double> weights) {
    double energy = 0.0;
    for (std::size_t e = 0; e < rings.edges.size(); ++e) {
        const double d =
            metric.distance(point_of(map, rings.edges[e].from), point_of(map, rings.edges[e].to));
        energy += 0.5 * weights[e] * d * d;
    }
    return energy;
}

// What differs between the two distances.
struct Flow {
    std::function<void(int)> centre;  // Moves one vertex.
    std::function<double()> energy;
};

HeatFlowReport sweep_until_still(GraphMap& map,
                                 const Flow& flow,
                                 const HeatFlowOptions& options,
                                 const Context& context) {
    const GraphMetric metric(map.graph);
    double longest = 0.0;
    for (const MetricGraph::Edge& edge : map.graph.edges) {
        longest = std::max(longest, edge.weight);
    }
    HeatFlowReport report;
    report.energies.push_back(flow.energy());
    while (!report.converged && report.sweeps() < options.most_sweeps) {
        double move = 0.0;
        for (int v = 0; v < static_cast<int>(map.t.size()); ++v) {
            if (v % kVerticesPerCheck == 0) {
                context.check();
            }
            if (map.fixed[at(v)] == 0) {
                const GraphPoint before = point_of(map, v);
                flow.centre(v);
                move = std::max(move, metric.distance(before, point_of(map, v)));
            }
        }
        const double before = report.energy();
        report.energies.push_back(flow.energy());
        report.residual = move / longest;
        report.converged = before - report.energy() < options.tolerance * before;
    }
    return report;
}

}  // namespace

double graph_distance_energy(const GraphMap& map,
                             const VertexRings& rings,
                             std::span<const double> weights) {
    return energy_in_graph(GraphMetric(map.graph), map, rings, weights);
}

HeatFlowReport heat_flow(GraphMap& map,
                         const VertexRings& rings,
                         std::span<const double> weights,
                         const HeatFlowOptions& options,
                         const Context& context) {
    if (options.distance == TargetDistance::Tree) {
        LocalStep step(map, rings, weights);
        return sweep_until_still(map,
                                 {.centre = [&](int v) { step.centre(v); },
                                  .energy = [&] { return map_energy(map, rings, weights); }},
                                 options, context);
    }
    const GraphMetric metric(map.graph);
    std::vector<WeightedPoint> neighbours;
    const auto centre = [&](int v) {
        neighbours.clear();
        for (int k = rings.begin[at(v)]; k < rings.begin[at(v) + 1]; ++k) {
            const RingSlot& slot = rings.slots[at(k)];
            neighbours.push_back({point_of(map, slot.neighbour), weights[at(slot.edge)]});
        }
        const GraphPoint place = metric.geodesic_centre(neighbours, map.graph_edge[at(v)]);
        map.graph_edge[at(v)] = place.edge;
        map.t[at(v)] = place.t;
    };
    return sweep_until_still(
        map,
        {.centre = centre, .energy = [&] { return energy_in_graph(metric, map, rings, weights); }},
        options, context);
}

}  // namespace leafcutter::geometry
