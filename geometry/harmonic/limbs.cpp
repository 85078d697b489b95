#include "geometry/harmonic/limbs.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace leafcutter::geometry {
namespace {

// A limb begins where the chart's scale falls below this part of its mean: still ten digits above
// rounding.
constexpr double kLimbScale = 1e-5;
// By how much edges along a limb are heavier. A tube keeps a linear profile instead of an
// exponential one for a ratio of (L / r)^2 / 2: this is enough for limbs of fifty radii.
constexpr double kPull = 1e3;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

double edge_length(const ChartMap& map, int h) {
    return (map.mesh.positions[at(map.edges.to_of(h))] -
            map.mesh.positions[at(map.edges.from_of(h))])
        .norm();
}

// Per vertex the length of its edges in the chart over their length on the surface.
std::vector<double> vertex_scales(const ChartMap& map) {
    std::vector<double> in_chart(map.gf.size(), 0.0);
    std::vector<double> on_surface(map.gf.size(), 0.0);
    for (int h = 0; h < map.edges.size(); ++h) {
        for (const int v : {map.edges.from_of(h), map.edges.to_of(h)}) {
            in_chart[at(v)] += map.difference(h).norm();
            on_surface[at(v)] += edge_length(map, h);
        }
    }
    double chart_sum = 0.0;
    double surface_sum = 0.0;
    for (std::size_t v = 0; v < in_chart.size(); ++v) {
        chart_sum += in_chart[v];
        surface_sum += on_surface[v];
    }
    for (std::size_t v = 0; v < in_chart.size(); ++v) {
        in_chart[v] *= surface_sum / (chart_sum * std::max(on_surface[v], 1e-300));
    }
    return in_chart;
}

// Half-edges both ways of each edge, sorted by start: offsets and (half-edge, end) pairs.
struct Neighbours {
    std::vector<int> start;
    std::vector<std::pair<int, int>> entries;
};

Neighbours neighbours_of(const ChartMap& map) {
    Neighbours out;
    out.start.assign(map.gf.size() + 1, 0);
    for (int h = 0; h < map.edges.size(); ++h) {
        ++out.start[at(map.edges.from_of(h)) + 1];
        ++out.start[at(map.edges.to_of(h)) + 1];
    }
    for (std::size_t v = 1; v < out.start.size(); ++v) {
        out.start[v] += out.start[v - 1];
    }
    out.entries.resize(at(out.start.back()));
    std::vector<int> cursor(out.start.begin(), out.start.end() - 1);
    for (int h = 0; h < map.edges.size(); ++h) {
        const int a = map.edges.from_of(h);
        const int b = map.edges.to_of(h);
        out.entries[at(cursor[at(a)]++)] = {h, b};
        out.entries[at(cursor[at(b)]++)] = {h, a};
    }
    return out;
}

}  // namespace

std::vector<double> limb_depths(const ChartMap& map) {
    const std::vector<double> scales = vertex_scales(map);
    std::vector<double> depths(map.gf.size(), std::numeric_limits<double>::infinity());
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (std::size_t v = 0; v < scales.size(); ++v) {
        if (scales[v] >= kLimbScale) {
            depths[v] = 0.0;
            queue.emplace(0.0, static_cast<int>(v));
        }
    }
    const Neighbours neighbours = neighbours_of(map);
    while (!queue.empty()) {
        const auto [depth, v] = queue.top();
        queue.pop();
        if (depth > depths[at(v)]) {
            continue;
        }
        for (int i = neighbours.start[at(v)]; i < neighbours.start[at(v) + 1]; ++i) {
            const auto [h, to] = neighbours.entries[at(i)];
            const double reached = depth + edge_length(map, h);
            if (reached < depths[at(to)]) {
                depths[at(to)] = reached;
                queue.emplace(reached, to);
            }
        }
    }
    return depths;
}

void pull_along_limbs(std::vector<WeightedEdge>& edges,
                      const ChartMap& map,
                      const std::vector<double>& depths) {
    for (WeightedEdge& edge : edges) {
        const double rise = std::abs(depths[at(edge.to)] - depths[at(edge.from)]);
        const double length = edge_length(map, edge.half_edge);
        if (rise > 0.0 && length > 0.0) {
            const double along = std::min(1.0, rise / length);
            edge.weight *= 1.0 + (kPull - 1.0) * along * along;
        }
    }
}

}  // namespace leafcutter::geometry
