#include "geometry/harmonic/form_zeros.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "geometry/laplacian.h"

namespace leafcutter::geometry {
namespace {

// Rings of vertices freed round irregular ones, one try after the other.
constexpr std::array<int, 6> kRings{1, 2, 3, 5, 8, 12};
// Least rise along an edge of a loop, as a part of what it would be by its length.
constexpr double kLeastStep = 0.02;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// What a walk round a vertex sees of the signs of g's rise from it.
struct Signs {
    int changes = 0;
    bool first = false;  // Along the outgoing boundary edge,
    bool last = false;   // and against the incoming one.
};

Signs signs_around(const HalfEdges& edges,
                   const std::vector<double>& rise,
                   int start,
                   bool natural) {
    Signs signs;
    bool known = false;
    bool before = false;
    const auto see = [&](bool sign) {
        signs.changes += known && sign != before ? 1 : 0;
        signs.first = known ? signs.first : sign;
        known = true;
        before = sign;
    };
    int h = start;
    for (;;) {
        const bool on_boundary = edges.twin_of(h) < 0;
        if (!(natural && on_boundary)) {
            see(rises(edges, rise, h));
        }
        const int next = turn_left(edges, h);
        if (next < 0) {
            if (!natural) {
                see(!rises(edges, rise, HalfEdges::previous(h)));
            }
            signs.last = before;
            return signs;
        }
        if (next == start) {
            signs.changes += before != signs.first ? 1 : 0;
            return signs;
        }
        h = next;
    }
}

bool is_regular_on_loop(const Signs& signs, std::uint8_t lines) {
    const bool forward = (lines & SourceLoop) != 0;
    return signs.changes == 1 && signs.first == forward && signs.last != forward;
}

void add_differences(const HalfEdges& edges,
                     std::vector<double>& rise,
                     const Eigen::VectorXd& values) {
    for (int h = 0; h < edges.size(); ++h) {
        rise[at(h)] += values[edges.to_of(h)] - values[edges.from_of(h)];
    }
}

// Steps of one loop, all made at least `least` without changing their sum.
void raise_steps(std::vector<double>& steps, const std::vector<double>& least) {
    double sum = 0.0;
    double least_sum = 0.0;
    double excess = 0.0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        sum += steps[i];
        least_sum += least[i];
        excess += std::max(steps[i] - least[i], 0.0);
    }
    for (std::size_t i = 0; i < steps.size(); ++i) {
        steps[i] = least[i] + std::max(steps[i] - least[i], 0.0) * (sum - least_sum) / excess;
    }
}

// Makes g monotone along sources and sinks where it isn't.
void make_loops_monotone(const ChartSurface& surface, std::vector<double>& rise) {
    const HalfEdges& edges = surface.edges;
    Eigen::VectorXd shift =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(surface.mesh.positions.size()));
    for (const std::vector<int>& walk : boundary_walks(edges)) {
        const std::uint8_t lines = surface.lines[at(edges.from_of(walk.front()))];
        if ((lines & NaturalLoop) != 0) {
            continue;
        }
        const double sign = (lines & SourceLoop) != 0 ? 1.0 : -1.0;
        std::vector<double> steps;
        std::vector<double> least;
        double sum = 0.0;
        double length = 0.0;
        for (const int h : walk) {
            steps.push_back(sign * rise[at(h)]);
            sum += steps.back();
            least.push_back((surface.mesh.positions[at(edges.to_of(h))] -
                             surface.mesh.positions[at(edges.from_of(h))])
                                .norm());
            length += least.back();
        }
        bool monotone = true;
        for (std::size_t i = 0; i < steps.size(); ++i) {
            least[i] *= kLeastStep * sum / length;
            monotone = monotone && steps[i] > 0.0;
        }
        if (monotone || !(sum > 0.0)) {
            continue;
        }
        const std::vector<double> before = steps;
        raise_steps(steps, least);
        double moved = 0.0;
        for (std::size_t i = 0; i + 1 < walk.size(); ++i) {
            moved += sign * (steps[i] - before[i]);
            shift[edges.to_of(walk[i])] = moved;
        }
    }
    add_differences(edges, rise, shift);
}

// Frees the interior vertices within `rings` rings of `irregular`.
std::vector<char> held_but_near(const ChartSurface& surface,
                                const std::vector<int>& irregular,
                                int rings) {
    const HalfEdges& edges = surface.edges;
    std::vector<char> held(surface.mesh.positions.size(), 1);
    for (const int v : irregular) {
        held[at(v)] = 0;
    }
    for (int ring = 0; ring < rings; ++ring) {
        const std::vector<char> before = held;
        for (int h = 0; h < edges.size(); ++h) {
            const int a = edges.from_of(h);
            const int b = edges.to_of(h);
            if (before[at(a)] == 0 || before[at(b)] == 0) {
                held[at(a)] = 0;
                held[at(b)] = 0;
            }
        }
    }
    return held;
}

void solve_where_free(const ChartSurface& surface,
                      std::vector<char> held,
                      const std::vector<WeightedEdge>& weights,
                      std::vector<double>& rise) {
    for (std::size_t v = 0; v < held.size(); ++v) {
        held[v] = held[v] != 0 || surface.lines[v] != 0 ? 1 : 0;
    }
    std::vector<WeightedEdge> active;
    std::vector<double> jump;
    for (const WeightedEdge& edge : weights) {
        if (held[at(edge.from)] == 0 || held[at(edge.to)] == 0) {
            active.push_back(edge);
            jump.push_back(rise[at(edge.half_edge)]);
        }
    }
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size()));
    add_differences(surface.edges, rise, HarmonicSolver(active, held).solve(zero, jump));
}

}  // namespace

bool rises(const HalfEdges& edges, const std::vector<double>& rise, int half_edge) {
    const double value = rise[at(half_edge)];
    return value > 0.0 || (value == 0.0 && edges.from_of(half_edge) < edges.to_of(half_edge));
}

FormZeros find_zeros(const ChartSurface& surface, const std::vector<double>& rise) {
    FormZeros found;
    const int count = static_cast<int>(surface.mesh.positions.size());
    const std::vector<int> first = first_outgoing(surface.edges, count);
    for (int v = 0; v < count; ++v) {
        if (first[at(v)] < 0) {
            continue;
        }
        const std::uint8_t lines = surface.lines[at(v)];
        const bool natural = (lines & NaturalLoop) != 0;
        const Signs signs = signs_around(surface.edges, rise, first[at(v)], natural);
        if ((lines & (SourceLoop | SinkLoop)) != 0) {
            if (!is_regular_on_loop(signs, lines)) {
                found.irregular.push_back(v);
            }
        } else if (!natural && signs.changes == 0) {
            found.irregular.push_back(v);
        } else if (signs.changes > (natural ? 0 : 2)) {
            found.zeros.push_back({v, signs.changes});
        }
    }
    return found;
}

FormZeros make_regular(const ChartSurface& surface, std::vector<double>& rise, FormRepair repair) {
    FormZeros found = find_zeros(surface, rise);
    if (found.irregular.empty()) {
        return found;
    }
    make_loops_monotone(surface, rise);
    found = find_zeros(surface, rise);
    const std::vector<WeightedEdge> weights = positive_edges(surface.mesh, surface.edges);
    for (const int rings : kRings) {
        if (found.irregular.empty()) {
            return found;
        }
        std::vector<double> tried = rise;
        solve_where_free(surface, held_but_near(surface, found.irregular, rings), weights, tried);
        FormZeros after = find_zeros(surface, tried);
        if (after.irregular.size() <= found.irregular.size()) {
            rise = std::move(tried);
            found = std::move(after);
        }
    }
    if (!found.irregular.empty() && repair == FormRepair::Everywhere) {
        solve_where_free(surface, std::vector<char>(surface.lines.size(), 0), weights, rise);
        found = find_zeros(surface, rise);
    }
    return found;
}

}  // namespace leafcutter::geometry
