#include "geometry/pants/sweep_function.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>

#include "geometry/laplacian.h"
#include "geometry/loops/edge_paths.h"

namespace leafcutter::geometry {
namespace {

// Inverse iterations for the Fiedler vector: the Reeb graph needs its shape, not its digits.
constexpr int kInverseIterations = 12;
// How far a retried coordinate leans towards each of the others, per attempt.
constexpr double kTilt = 0.02;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

int farthest(const std::vector<double>& length) {
    return static_cast<int>(std::max_element(length.begin(), length.end()) - length.begin());
}

std::vector<WeightedEdge> weighted_edges(const DecompositionSurface& surface) {
    std::vector<WeightedEdge> edges;
    edges.reserve(surface.rings.edges.size());
    for (std::size_t e = 0; e < surface.rings.edges.size(); ++e) {
        const MeshEdge& edge = surface.rings.edges[e];
        edges.push_back({edge.from, edge.to, surface.weights[e], edge.half_edge});
    }
    return edges;
}

// Harmonic with its only extrema where it is held: 0 on one boundary loop (or at one end of the
// surface), 1 on all others (or at the other end). Attempts start at other loops and ends.
SweepValues harmonic(const DecompositionSurface& surface, int attempt) {
    const auto& loops = surface.boundary_loops;
    std::vector<char> held(surface.positions.size(), 0);
    Eigen::VectorXd start = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size()));
    const auto hold = [&](int v, double value) {
        held[at(v)] = 1;
        start[v] = value;
    };
    SweepValues sweep;
    sweep.loop_is_low.assign(loops.size(), 0);
    if (loops.empty()) {
        // The ends of the longest way; attempts start at other places, far from all before.
        std::vector<int> ends{
            farthest(path_lengths(surface.rings, surface.positions, std::array{0}))};
        for (int k = 0; k <= attempt; ++k) {
            ends.push_back(farthest(path_lengths(surface.rings, surface.positions, ends)));
        }
        const int low = attempt == 0 ? ends.front() : ends.back();
        hold(low, 0.0);
        hold(farthest(path_lengths(surface.rings, surface.positions, std::array{low})), 1.0);
    } else {
        const std::size_t source = at(attempt) % loops.size();
        sweep.loop_is_low[source] = 1;
        for (std::size_t k = 0; k < loops.size(); ++k) {
            for (const int v : loops[k]) {
                hold(v, k == source ? 0.0 : 1.0);
            }
        }
        if (loops.size() == 1) {
            std::vector<int> far = loops[0];
            for (int k = 0; k <= attempt; ++k) {
                far.push_back(farthest(path_lengths(surface.rings, surface.positions, far)));
            }
            hold(far.back(), 1.0);
            sweep.loop_is_low[0] = 1;
        }
    }
    const std::vector<WeightedEdge> edges = weighted_edges(surface);
    const Eigen::VectorXd values = HarmonicSolver(edges, held).solve(std::move(start));
    sweep.values.assign(values.data(), values.data() + values.size());
    return sweep;
}

std::vector<double> coordinate(const DecompositionSurface& surface, int axis, int attempt) {
    Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
    direction[(axis + 1) % 3] = kTilt * attempt;
    direction[(axis + 2) % 3] = -0.7 * kTilt * attempt;
    std::vector<double> values;
    values.reserve(surface.positions.size());
    for (const Eigen::Vector3d& p : surface.positions) {
        values.push_back(direction.dot(p));
    }
    return values;
}

std::vector<double> vertex_areas(const DecompositionSurface& surface) {
    std::vector<double> area(surface.positions.size(), 0.0);
    for (const auto& t : surface.triangles) {
        const Eigen::Vector3d& a = surface.positions[at(t[0])];
        const Eigen::Vector3d ab = surface.positions[at(t[1])] - a;
        const Eigen::Vector3d ac = surface.positions[at(t[2])] - a;
        const double third = ab.cross(ac).norm() / 6.0;
        for (const int v : t) {
            area[at(v)] += third;
        }
    }
    return area;
}

// The eigenfunction of the Laplacian with the second least eigenvalue, or nearly: by inverse
// iteration with the mass of vertices, one vertex held and the mean taken off instead of it.
std::vector<double> fiedler(const DecompositionSurface& surface, int attempt) {
    const std::vector<double> mass = vertex_areas(surface);
    const int count = static_cast<int>(mass.size());
    std::vector<MatrixEntry> lower;  // Without the last row: the Laplacian itself is singular.
    for (std::size_t e = 0; e < surface.rings.edges.size(); ++e) {
        const int a = std::max(surface.rings.edges[e].from, surface.rings.edges[e].to);
        const int b = std::min(surface.rings.edges[e].from, surface.rings.edges[e].to);
        const double w = surface.weights[e];
        lower.push_back({b, b, w});
        if (a < count - 1) {
            lower.push_back({a, a, w});
            lower.push_back({a, b, -w});
        }
    }
    const SparseSolver solver(count - 1, lower);
    std::minstd_rand random(static_cast<unsigned>(attempt) + 1U);
    Eigen::VectorXd u(count);
    for (int v = 0; v < count; ++v) {
        u[v] = static_cast<double>(random() % 1000);
    }
    const Eigen::VectorXd m = Eigen::Map<const Eigen::VectorXd>(mass.data(), count);
    const auto remove_mean = [&] { u.array() -= m.dot(u) / m.sum(); };
    remove_mean();
    // A retry stops early: its function is smooth, but another one.
    const int iterations = std::max(2, kInverseIterations - 3 * attempt);
    for (int k = 0; k < iterations; ++k) {
        u /= std::sqrt(u.dot(m.cwiseProduct(u)));
        const Eigen::VectorXd right = m.cwiseProduct(u);
        u.head(count - 1) = solver.solve(right.head(count - 1));
        u[count - 1] = 0.0;
        remove_mean();
    }
    return {u.data(), u.data() + u.size()};
}

// Loops in the lower half of the function are swept first, the others last.
SweepValues with_loops(const DecompositionSurface& surface, std::vector<double> values) {
    SweepValues sweep{std::move(values), {}};
    if (surface.boundary_loops.empty()) {
        return sweep;
    }
    const auto [low, high] = std::minmax_element(sweep.values.begin(), sweep.values.end());
    const double middle = 0.5 * (*low + *high);
    for (const std::vector<int>& loop : surface.boundary_loops) {
        double sum = 0.0;
        for (const int v : loop) {
            sum += sweep.values[at(v)];
        }
        sweep.loop_is_low.push_back(sum < middle * static_cast<double>(loop.size()) ? 1 : 0);
    }
    return sweep;
}

}  // namespace

SweepValues sweep_values(const DecompositionSurface& surface, SweepFunction function, int attempt) {
    switch (function) {
        case SweepFunction::X:
        case SweepFunction::Y:
        case SweepFunction::Z: {
            const int axis = static_cast<int>(function) - static_cast<int>(SweepFunction::X);
            return with_loops(surface, coordinate(surface, axis, attempt));
        }
        case SweepFunction::Fiedler:
            return with_loops(surface, fiedler(surface, attempt));
        case SweepFunction::Auto:
        case SweepFunction::Harmonic:
            break;
    }
    return harmonic(surface, attempt);
}

}  // namespace leafcutter::geometry
