#include "geometry/pants/graph_metric.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace leafcutter::geometry {
namespace {

// A centre on another edge has to be better by this part to win, or rounding would choose.
constexpr double kClearlyBetter = 1e-14;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Distance to a point as a function of the place q on one edge: the least of lines of slope 1 and
// -1, and of |q - own| for a point on that edge.
struct Profile {
    double weight = 0.0;
    double from_start = 0.0;  // Distance at q = 0 ...
    double from_end = 0.0;    // ... and at q = length.
    double own = -1.0;        // The point's own place on the edge, -1 if on another.
};

// distance = slope q + offset, near a q.
struct Line {
    double slope = 0.0;
    double offset = 0.0;
};

Line line_at(const Profile& profile, double length, double q) {
    const std::array<Line, 2> round{Line{1.0, profile.from_start},
                                    Line{-1.0, profile.from_end + length}};
    Line best = round[0].offset + q <= round[1].offset - q ? round[0] : round[1];
    if (profile.own >= 0.0 && std::abs(q - profile.own) <= best.slope * q + best.offset) {
        best = q >= profile.own ? Line{1.0, -profile.own} : Line{-1.0, profile.own};
    }
    return best;
}

// Places where some profile changes from one line to another, in order, ends of the edge included.
std::vector<double> breaks_of(std::span<const Profile> profiles, double length) {
    std::vector<double> breaks{0.0, length};
    const auto add = [&](double q) {
        if (q > 0.0 && q < length) {
            breaks.push_back(q);
        }
    };
    for (const Profile& p : profiles) {
        add(0.5 * (p.from_end + length - p.from_start));
        if (p.own >= 0.0) {
            add(p.own);
            add(0.5 * (p.own - p.from_start));
            add(0.5 * (p.own + p.from_end + length));
        }
    }
    std::sort(breaks.begin(), breaks.end());
    return breaks;
}

struct Least {
    double q = 0.0;
    double moment = std::numeric_limits<double>::infinity();
};

// The best place on one edge: on each piece between breaks the moment is one parabola.
Least least_on_edge(std::span<const Profile> profiles, double length) {
    const std::vector<double> breaks = breaks_of(profiles, length);
    Least best;
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
        const double middle = 0.5 * (breaks[k] + breaks[k + 1]);
        double total = 0.0;
        double pull = 0.0;
        std::vector<Line> lines;
        for (const Profile& p : profiles) {
            lines.push_back(line_at(p, length, middle));
            total += p.weight;
            pull -= p.weight * lines.back().slope * lines.back().offset;
        }
        const double q = std::clamp(pull / total, breaks[k], breaks[k + 1]);
        double moment = 0.0;
        for (std::size_t i = 0; i < lines.size(); ++i) {
            const double d = lines[i].slope * q + lines[i].offset;
            moment += profiles[i].weight * d * d;
        }
        if (moment < best.moment) {
            best = {q, moment};
        }
    }
    return best;
}

}  // namespace

GraphMetric::GraphMetric(const MetricGraph& graph)
    : nodes_(graph.nodes),
      edges_(graph.edges),
      between_(at(graph.nodes) * at(graph.nodes), std::numeric_limits<double>::infinity()),
      first_(between_.size(), -1) {
    const auto place = [&](int a, int b) { return pair_of(a, b); };
    for (int node = 0; node < nodes_; ++node) {
        between_[place(node, node)] = 0.0;
    }
    for (std::size_t e = 0; e < edges_.size(); ++e) {
        const auto [from, to, length] = edges_[e];
        if (length < between_[place(from, to)]) {
            between_[place(from, to)] = between_[place(to, from)] = length;
            first_[place(from, to)] = static_cast<Dart>(2 * e);
            first_[place(to, from)] = static_cast<Dart>(2 * e + 1);
        }
    }
    for (int over = 0; over < nodes_; ++over) {  // Floyd and Warshall.
        for (int a = 0; a < nodes_; ++a) {
            for (int b = 0; b < nodes_; ++b) {
                const double detour = between_[place(a, over)] + between_[place(over, b)];
                if (detour < between_[place(a, b)]) {
                    between_[place(a, b)] = detour;
                    first_[place(a, b)] = first_[place(a, over)];
                }
            }
        }
    }
}

double GraphMetric::reach(int node, GraphPoint point) const {
    const MetricGraph::Edge& edge = edges_[at(point.edge)];
    return std::min(node_distance(node, edge.from) + point.t,
                    node_distance(node, edge.to) + edge.weight - point.t);
}

double GraphMetric::distance(GraphPoint a, GraphPoint b) const {
    const MetricGraph::Edge& edge = edges_[at(a.edge)];
    const double round = std::min(a.t + reach(edge.from, b), edge.weight - a.t + reach(edge.to, b));
    return a.edge == b.edge ? std::min(round, std::abs(a.t - b.t)) : round;
}

Word GraphMetric::shortest_path(GraphPoint a, GraphPoint b) const {
    double best = a.edge == b.edge ? std::abs(a.t - b.t) : std::numeric_limits<double>::infinity();
    std::array<Dart, 2> ends{-1, -1};
    for (const Dart out : {2 * a.edge, 2 * a.edge + 1}) {
        for (const Dart in : {2 * b.edge, 2 * b.edge + 1}) {
            const MetricGraph::Edge& own = edges_[at(a.edge)];
            const MetricGraph::Edge& other = edges_[at(b.edge)];
            const double before = runs_forward(out) ? own.weight - a.t : a.t;
            const double after = runs_forward(in) ? b.t : other.weight - b.t;
            const double through = before + after +
                                   node_distance(runs_forward(out) ? own.to : own.from,
                                                 runs_forward(in) ? other.from : other.to);
            if (through < best) {
                best = through;
                ends = {out, in};
            }
        }
    }
    if (ends[0] < 0) {
        return {};
    }
    const auto tail = [&](Dart dart) {
        const MetricGraph::Edge& edge = edges_[at(edge_of(dart))];
        return runs_forward(dart) ? edge.from : edge.to;
    };
    Word word{ends[0]};
    const int goal = tail(ends[1]);
    for (int node = tail(reversed(ends[0])); node != goal; node = tail(reversed(word.back()))) {
        word.push_back(first_[pair_of(node, goal)]);
    }
    word.push_back(ends[1]);
    return word;
}

double GraphMetric::moment(std::span<const WeightedPoint> points, GraphPoint centre) const {
    double sum = 0.0;
    for (const auto& [point, weight] : points) {
        const double d = distance(point, centre);
        sum += weight * d * d;
    }
    return sum;
}

// All points on one edge, and any way round between the first and the last more than three times as
// long as the straight one: then nothing beyond them is nearer to any than one of the two, and the
// centre is the mean.
bool GraphMetric::is_compact(std::span<const WeightedPoint> points) const {
    double low = points.front().point.t;
    double high = low;
    const int edge = points.front().point.edge;
    for (const auto& [point, weight] : points) {
        if (point.edge != edge) {
            return false;
        }
        low = std::min(low, point.t);
        high = std::max(high, point.t);
    }
    const auto [from, to, length] = edges_[at(edge)];
    return low + length - high + node_distance(from, to) >= 3.0 * (high - low);
}

GraphPoint GraphMetric::geodesic_centre(std::span<const WeightedPoint> points,
                                        int preferred) const {
    if (is_compact(points)) {
        double total = 0.0;
        double sum = 0.0;
        for (const auto& [point, weight] : points) {
            total += weight;
            sum += weight * point.t;
        }
        return {points.front().point.edge, sum / total};
    }
    std::vector<Profile> profiles(points.size());
    GraphPoint best{preferred, 0.0};
    double least = std::numeric_limits<double>::infinity();
    const int count = static_cast<int>(edges_.size());
    for (int k = -1; k < count; ++k) {
        const int e = k < 0 ? preferred : k;
        const auto [from, to, length] = edges_[at(e)];
        for (std::size_t i = 0; i < points.size(); ++i) {
            const GraphPoint& point = points[i].point;
            profiles[i] = {points[i].weight, reach(from, point), reach(to, point),
                           point.edge == e ? point.t : -1.0};
        }
        const Least found = least_on_edge(profiles, length);
        if (found.moment < least * (1.0 - kClearlyBetter)) {
            least = found.moment;
            best = {e, found.q};
        }
    }
    return best;
}

}  // namespace leafcutter::geometry
