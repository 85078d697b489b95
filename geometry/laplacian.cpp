#include "geometry/laplacian.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

// Bounds of the weights of positive_edges(). The cotangent of a good triangle is about 0.6.
constexpr double kLargestWeight = 50.0;
// Added to a diagonal that rounding has made singular, by the sum of its weights' sizes.
constexpr double kRounding = 1e-10;
constexpr double kHair = 1e-9;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

double extrinsic_cotangent(const TriangleMesh& mesh, const HalfEdges& edges, int half_edge) {
    const Eigen::Vector3d& apex = mesh.positions[at(edges.from_of(HalfEdges::previous(half_edge)))];
    const Eigen::Vector3d a = mesh.positions[at(edges.from_of(half_edge))] - apex;
    const Eigen::Vector3d b = mesh.positions[at(edges.to_of(half_edge))] - apex;
    const double doubled_area = a.cross(b).norm();
    return doubled_area > 0.0 ? a.dot(b) / doubled_area : 0.0;
}

}  // namespace

std::vector<WeightedEdge> cotangent_edges(const IntrinsicTriangulation& triangulation) {
    const HalfEdges& edges = triangulation.edges;
    std::vector<WeightedEdge> out;
    out.reserve(at(edges.size()));
    for (int h = 0; h < edges.size(); ++h) {
        if (!edges.is_first(h)) {
            continue;
        }
        double weight = 0.5 * facing_cotangent(triangulation, h);
        if (edges.twin_of(h) >= 0) {
            // What is left below zero after the flips is rounding.
            weight =
                std::max(0.0, weight + 0.5 * facing_cotangent(triangulation, edges.twin_of(h)));
        }
        out.push_back({edges.from_of(h), edges.to_of(h), weight, h});
    }
    return out;
}

std::vector<WeightedEdge> positive_edges(const TriangleMesh& mesh,
                                         const HalfEdges& edges,
                                         double least) {
    std::vector<WeightedEdge> out;
    out.reserve(at(edges.size()));
    for (int h = 0; h < edges.size(); ++h) {
        if (!edges.is_first(h)) {
            continue;
        }
        double weight = 0.5 * extrinsic_cotangent(mesh, edges, h);
        if (edges.twin_of(h) >= 0) {
            weight += 0.5 * extrinsic_cotangent(mesh, edges, edges.twin_of(h));
        }
        weight = std::clamp(weight, least, kLargestWeight);
        out.push_back({edges.from_of(h), edges.to_of(h), weight, h});
    }
    return out;
}

double dirichlet_energy(std::span<const WeightedEdge> edges,
                        const Eigen::VectorXd& values,
                        std::span<const double> jump) {
    double sum = 0.0;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const double rise =
            values[edges[e].to] - values[edges[e].from] + (jump.empty() ? 0.0 : jump[e]);
        sum += edges[e].weight * rise * rise;
    }
    return 0.5 * sum;
}

namespace {

// Fluxes through the levels between neighbouring places, from where they change.
double relative_range(std::vector<std::pair<double, double>> changes) {
    if (changes.empty()) {
        return 0.0;
    }
    std::sort(changes.begin(), changes.end());
    // Levels this close to the ends or to each other are told apart by rounding alone.
    const double hair = kHair * (changes.back().first - changes.front().first);
    const double first = changes.front().first + hair;
    const double last = changes.back().first - hair;
    double flux = 0.0;
    double least = std::numeric_limits<double>::infinity();
    double most = 0.0;
    for (std::size_t i = 0; i + 1 < changes.size(); ++i) {
        flux += changes[i].second;
        const double here = changes[i].first;
        const double next = changes[i + 1].first;
        if (next - here > hair && next > first && here < last) {
            least = std::min(least, flux);
            most = std::max(most, flux);
        }
    }
    return most > 0.0 ? (most - least) / most : 0.0;
}

}  // namespace

double flux_variation(std::span<const WeightedEdge> edges, const Eigen::VectorXd& values) {
    // The flux through the level c is the sum of w (high - low) over edges with low < c < high.
    std::vector<std::pair<double, double>> changes;
    changes.reserve(2 * edges.size());
    for (const WeightedEdge& edge : edges) {
        const double a = values[edge.from];
        const double b = values[edge.to];
        if (a != b) {
            const double flux = edge.weight * std::abs(b - a);
            changes.emplace_back(std::min(a, b), flux);
            changes.emplace_back(std::max(a, b), -flux);
        }
    }
    return relative_range(std::move(changes));
}

HarmonicSolver::HarmonicSolver(std::span<const WeightedEdge> edges, const std::vector<char>& held)
    : edges_(edges), unknown_of_vertex_(held.size(), -1) {
    for (std::size_t v = 0; v < held.size(); ++v) {
        if (held[v] == 0) {
            unknown_of_vertex_[v] = unknowns_++;
        }
    }
    if (unknowns_ == 0) {
        return;
    }
    std::vector<MatrixEntry> lower;
    lower.reserve(edges.size() * 3);
    std::vector<double> size(static_cast<std::size_t>(unknowns_), 0.0);
    for (const WeightedEdge& edge : edges) {
        const int a = unknown_of_vertex_[at(edge.from)];
        const int b = unknown_of_vertex_[at(edge.to)];
        if (a == b) {
            continue;  // Both held, or a loop: no term in the unknowns.
        }
        for (const int v : {a, b}) {
            if (v >= 0) {
                lower.push_back({v, v, edge.weight});
                size[at(v)] += std::abs(edge.weight);
            }
        }
        if (a >= 0 && b >= 0) {
            lower.push_back({std::max(a, b), std::min(a, b), -edge.weight});
        }
    }
    try {
        solver_.emplace(unknowns_, lower);
    } catch (const Error&) {
        // Needles on a boundary have weights of large size that cancel, but for rounding.
        for (int v = 0; v < unknowns_; ++v) {
            lower.push_back({v, v, kRounding * size[at(v)]});
        }
        solver_.emplace(unknowns_, lower);
    }
}

Eigen::VectorXd HarmonicSolver::solve(Eigen::VectorXd values, std::span<const double> jump) const {
    if (unknowns_ == 0) {
        return values;
    }
    // Gradient of the energy with zero at the unknowns, negated.
    Eigen::VectorXd right_side = Eigen::VectorXd::Zero(unknowns_);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
        const WeightedEdge& edge = edges_[e];
        const int a = unknown_of_vertex_[at(edge.from)];
        const int b = unknown_of_vertex_[at(edge.to)];
        const double held_rise = (b < 0 ? values[edge.to] : 0.0) -
                                 (a < 0 ? values[edge.from] : 0.0) + (jump.empty() ? 0.0 : jump[e]);
        if (a >= 0) {
            right_side[a] += edge.weight * held_rise;
        }
        if (b >= 0) {
            right_side[b] -= edge.weight * held_rise;
        }
    }
    const Eigen::VectorXd solution = solver_->solve(right_side);
    if (!solution.allFinite()) {
        throw Error(
            ErrorKind::SelfCheck, "singular-system",
            "a harmonic function of the foliation is not finite: the mesh is too degenerate; "
            "repair or remesh it");
    }
    for (std::size_t v = 0; v < unknown_of_vertex_.size(); ++v) {
        if (unknown_of_vertex_[v] >= 0) {
            values[static_cast<Eigen::Index>(v)] = solution[unknown_of_vertex_[v]];
        }
    }
    return values;
}

}  // namespace leafcutter::geometry
