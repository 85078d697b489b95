#include "geometry/harmonic/bijectivity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "geometry/harmonic/limbs.h"
#include "geometry/laplacian.h"

namespace leafcutter::geometry {
namespace {

// Rings of vertices freed round flipped triangles, one try after the other.
constexpr std::array<int, 6> kRings{1, 2, 3, 5, 8, 12};
// Least step along a rail, as a part of the step that the edge's length would have.
constexpr double kLeastStep = 0.02;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

double edge_length(const ChartMap& map, int a, int b) {
    return (map.mesh.positions[at(a)] - map.mesh.positions[at(b)]).norm();
}

// The boundary half-edge out of each vertex, or -1.
std::vector<int> boundary_edges(const ChartMap& map) {
    std::vector<int> out(map.gf.size(), -1);
    for (int h = 0; h < map.edges.size(); ++h) {
        if (map.edges.twin_of(h) < 0) {
            out[at(map.edges.from_of(h))] = h;
        }
    }
    return out;
}

double lifted_step(const ChartMap& map,
                   const std::vector<int>& boundary,
                   std::pair<int, int> ends,
                   int axis) {
    const auto [a, b] = ends;
    const int forward = boundary[at(a)];
    if (forward >= 0 && map.edges.to_of(forward) == b) {
        return map.difference(forward)[axis];
    }
    return -map.difference(boundary[at(b)])[axis];
}

// Positions along a rail, one more than edges, lifted.
std::vector<double> rail_positions(const ChartMap& map,
                                   const std::vector<int>& boundary,
                                   const Rail& rail) {
    std::vector<double> positions{map.gf[at(rail.vertices.front())][rail.axis]};
    const std::size_t edges = rail.vertices.size() - (rail.closed ? 0 : 1);
    for (std::size_t i = 0; i < edges; ++i) {
        const int a = rail.vertices[i];
        const int b = rail.vertices[(i + 1) % rail.vertices.size()];
        positions.push_back(positions.back() + lifted_step(map, boundary, {a, b}, rail.axis));
    }
    return positions;
}

// Least allowed step of each edge: what it has, if that is positive and less than kLeastStep of its
// share by length.
std::vector<double> least_steps(const ChartMap& map,
                                const Rail& rail,
                                const std::vector<double>& positions) {
    std::vector<double> lengths;
    double total = 0.0;
    for (std::size_t i = 0; i + 1 < positions.size(); ++i) {
        lengths.push_back(
            edge_length(map, rail.vertices[i], rail.vertices[(i + 1) % rail.vertices.size()]));
        total += lengths.back();
    }
    const double range = positions.back() - positions.front();
    std::vector<double> steps(lengths.size());
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const double share = std::max(lengths[i] / total, 1e-3 / static_cast<double>(steps.size()));
        const double present = positions[i + 1] - positions[i];
        const double least = kLeastStep * share * range;
        steps[i] = present > 1e-3 * least ? std::min(present, least) : least;
    }
    return steps;
}

// Least-squares non-decreasing fit by pooling adjacent violators, held at both ends.
void make_non_decreasing(std::vector<double>& values) {
    struct Pool {
        double sum;
        std::size_t count;
        double mean() const { return sum / static_cast<double>(count); }
    };
    const double first = values.front();
    const double last = values.back();
    std::vector<Pool> pools;
    for (const double value : values) {
        pools.push_back({value, 1});
        while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
            const Pool top = pools.back();
            pools.pop_back();
            pools.back().sum += top.sum;
            pools.back().count += top.count;
        }
    }
    std::size_t i = 0;
    for (const Pool& pool : pools) {
        for (std::size_t k = 0; k < pool.count; ++k) {
            values[i++] = std::clamp(pool.mean(), first, last);
        }
    }
}

void make_monotone(ChartMap& map, const std::vector<int>& boundary, const Rail& rail) {
    std::vector<double> positions = rail_positions(map, boundary, rail);
    const std::vector<double> before = positions;
    const std::vector<double> steps = least_steps(map, rail, positions);
    double offset = 0.0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        offset += steps[i];
        positions[i + 1] -= offset;
    }
    make_non_decreasing(positions);
    offset = 0.0;
    for (std::size_t i = 0; i < rail.vertices.size(); ++i) {
        map.gf[at(rail.vertices[i])][rail.axis] += positions[i] + offset - before[i];
        offset += i < steps.size() ? steps[i] : 0.0;
    }
}

// Closed rails start where their step is largest: their ends are held, and that edge can spare
// most.
Rail turned_to_largest_step(const ChartMap& map, const std::vector<int>& boundary, Rail rail) {
    if (!rail.closed) {
        return rail;
    }
    const std::vector<double> positions = rail_positions(map, boundary, rail);
    std::size_t largest = 0;
    for (std::size_t i = 0; i + 1 < positions.size(); ++i) {
        if (positions[i + 1] - positions[i] > positions[largest + 1] - positions[largest]) {
            largest = i;
        }
    }
    std::rotate(rail.vertices.begin(), rail.vertices.begin() + static_cast<std::ptrdiff_t>(largest),
                rail.vertices.end());
    return rail;
}

// Frees the vertices within `rings` rings of the triangles in `bad`.
std::vector<char> held_but_near(const ChartMap& map, const std::vector<int>& bad, int rings) {
    std::vector<char> held(map.gf.size(), 1);
    for (const int t : bad) {
        for (const int v : map.mesh.triangles[at(t)]) {
            held[at(v)] = 0;
        }
    }
    for (int ring = 1; ring < rings; ++ring) {
        const std::vector<char> before = held;
        for (int h = 0; h < map.edges.size(); ++h) {
            if (before[at(map.edges.from_of(h))] == 0) {
                held[at(map.edges.to_of(h))] = 0;
            }
            if (before[at(map.edges.to_of(h))] == 0) {
                held[at(map.edges.from_of(h))] = 0;
            }
        }
    }
    return held;
}

void hold_rails(std::vector<char>& held, const std::vector<Rail>& rails) {
    for (const Rail& rail : rails) {
        for (const int v : rail.vertices) {
            held[at(v)] = 1;
        }
    }
}

// Both coordinates harmonic with respect to `edges` where not held.
void solve_again(ChartMap& map,
                 const std::vector<WeightedEdge>& edges,
                 const std::vector<char>& held) {
    // Edges between held vertices say nothing; leaving them out makes local steps cheap.
    std::vector<WeightedEdge> active;
    for (const WeightedEdge& edge : edges) {
        if (held[at(edge.from)] == 0 || held[at(edge.to)] == 0) {
            active.push_back(edge);
        }
    }
    const HarmonicSolver solver(active, held);
    for (int axis = 0; axis < 2; ++axis) {
        std::vector<double> jump;
        if (!map.jump.empty()) {
            for (const WeightedEdge& edge : active) {
                jump.push_back(map.jump[at(edge.half_edge)][axis]);
            }
        }
        Eigen::VectorXd values(static_cast<Eigen::Index>(map.gf.size()));
        for (std::size_t v = 0; v < map.gf.size(); ++v) {
            values[static_cast<Eigen::Index>(v)] = map.gf[v][axis];
        }
        values = solver.solve(std::move(values), jump);
        for (std::size_t v = 0; v < map.gf.size(); ++v) {
            map.gf[v][axis] = values[static_cast<Eigen::Index>(v)];
        }
    }
}

// Frees the vertices within `rings` rings of the triangles in `bad`, solves there, and keeps the
// answer unless it is worse. Returns the triangles still bad.
std::vector<int> repair_near(ChartMap& map,
                             std::vector<int> bad,
                             const std::vector<WeightedEdge>& edges,
                             const std::vector<Rail>& rails,
                             int rings) {
    std::vector<char> held = held_but_near(map, bad, rings);
    hold_rails(held, rails);
    if (std::count(held.begin(), held.end(), 1) == 0) {
        held.front() = 1;  // A torus without rails: one vertex stays.
    }
    std::vector<Eigen::Vector2d> before = map.gf;
    solve_again(map, edges, held);
    std::vector<int> left = bad_triangles(map);
    if (left.size() > bad.size()) {
        map.gf = std::move(before);
        return bad;
    }
    return left;
}

// Tries the weights given, then equal ones, which spread the vertices of a heap of needles best,
// near the flipped triangles and then ever farther from them.
bool repair_locally(ChartMap& map,
                    const std::vector<WeightedEdge>& edges,
                    const std::vector<Rail>& rails) {
    std::vector<WeightedEdge> equal = edges;
    for (WeightedEdge& edge : equal) {
        edge.weight = 1.0;
    }
    std::vector<int> bad = bad_triangles(map);
    for (const int rings : kRings) {
        for (const std::vector<WeightedEdge>& weights : {std::cref(edges), std::cref(equal)}) {
            if (bad.empty()) {
                return true;
            }
            bad = repair_near(map, std::move(bad), weights, rails, rings);
        }
    }
    return bad.empty();
}

// Opens limbs that the chart shrank to nothing, everything else held. Returns whether there are
// any.
bool open_limbs(ChartMap& map, std::vector<WeightedEdge>& edges, const std::vector<Rail>& rails) {
    const std::vector<double> depths = limb_depths(map);
    std::vector<char> held(depths.size());
    std::transform(depths.begin(), depths.end(), held.begin(),
                   [](double depth) { return static_cast<char>(depth > 0.0 ? 0 : 1); });
    hold_rails(held, rails);
    const auto freed = std::count(held.begin(), held.end(), 0);
    if (freed == 0 || freed == static_cast<std::ptrdiff_t>(held.size())) {
        return false;
    }
    pull_along_limbs(edges, map, depths);
    solve_again(map, edges, held);
    return true;
}

}  // namespace

FlipReport make_bijective(ChartMap& map, const std::vector<Rail>& rails, const Context& context) {
    FlipReport report;
    report.flipped_as_solved = static_cast<int>(bad_triangles(map).size());
    if (report.flipped_as_solved == 0) {
        return report;
    }
    context.check();
    const std::vector<int> boundary = boundary_edges(map);
    for (const Rail& rail : rails) {
        make_monotone(map, boundary, turned_to_largest_step(map, boundary, rail));
    }
    std::vector<WeightedEdge> edges = positive_edges(map.mesh, map.edges);
    report.opened_limbs = open_limbs(map, edges, rails);
    if (repair_locally(map, edges, rails)) {
        return report;
    }
    context.check();
    report.whole_chart = true;
    std::vector<char> held(map.gf.size(), 0);
    hold_rails(held, rails);
    if (rails.empty()) {
        held.front() = 1;
    }
    solve_again(map, edges, held);
    return report;
}

}  // namespace leafcutter::geometry
