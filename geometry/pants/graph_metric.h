// Shortest paths in a metric graph, and the weighted geodesic centre of points of it, as
// section 3.3 prints them.
//
// This is the distance of the graph itself. The harmonic map is into the graph's unfolding, a tree
// (tree_word.h); with the distance of the graph, kept here as a reference, minima have broken
// cylinders.

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/pants/tree_word.h"

namespace leafcutter::geometry {

struct GraphPoint {
    int edge = 0;
    double t = 0.0;  // In [0, weight of the edge], from its `from`.
};

struct WeightedPoint {
    GraphPoint point;
    double weight = 0.0;  // Positive.
};

class GraphMetric {
public:
    explicit GraphMetric(const MetricGraph& graph);

    double distance(GraphPoint a, GraphPoint b) const;

    // The darts of a shortest path, own edges of both ends included; empty if it stays inside one
    // edge.
    Word shortest_path(GraphPoint a, GraphPoint b) const;

    // Sum of weight x distance squared from `centre` to `points`.
    double moment(std::span<const WeightedPoint> points, GraphPoint centre) const;

    // The point of the whole graph of least moment, exact up to rounding. Of several equally good
    // ones the one on edge `preferred`, else of lowest edge and t.
    GraphPoint geodesic_centre(std::span<const WeightedPoint> points, int preferred) const;

private:
    double weight(int edge) const { return edges_[static_cast<std::size_t>(edge)].weight; }
    std::size_t pair_of(int a, int b) const {
        return static_cast<std::size_t>(a) * static_cast<std::size_t>(nodes_) +
               static_cast<std::size_t>(b);
    }
    double node_distance(int a, int b) const { return between_[pair_of(a, b)]; }
    // From a node to a point.
    double reach(int node, GraphPoint point) const;
    bool is_compact(std::span<const WeightedPoint> points) const;

    int nodes_ = 0;
    std::vector<MetricGraph::Edge> edges_;
    std::vector<double> between_;  // Node to node.
    std::vector<Dart> first_;      // First dart of a shortest path from node to node, -1: none.
};

}  // namespace leafcutter::geometry
