#include "geometry/harmonic/resolve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace leafcutter::geometry {
namespace {

constexpr double kWantedGap = 0.005;
// Surfaces of more vertices are taken as they are: refining one costs more than it gains.
constexpr std::size_t kEnoughVertices = 30000;
constexpr int kMostRounds = 10;
// Part of the error whose triangles are split in one round.
constexpr double kSplitShare = 0.6;

// Half the integral of |grad g - grad f turned|^2: zero where (g, f) is conformal.
double conformal_defect(const ChartMap& map, int t) {
    const auto& triangle = map.mesh.triangles[static_cast<std::size_t>(t)];
    const auto position = [&](std::size_t k) {
        return map.mesh.positions[static_cast<std::size_t>(triangle[k])];
    };
    const Eigen::Vector3d a = position(1) - position(0);
    const Eigen::Vector3d b = position(2) - position(0);
    const double base = a.norm();
    const double doubled_area = a.cross(b).norm();
    if (!(base > 0.0) || !(doubled_area > 1e-9 * (a.squaredNorm() + b.squaredNorm()))) {
        return 0.0;
    }
    // Differences along orthonormal axes of the triangle's plane.
    const auto gf = lifted_corners(map, t);
    const Eigen::Vector2d along = (gf[1] - gf[0]) / base;
    const Eigen::Vector2d across =
        (gf[2] - gf[0] - along * (a.dot(b) / base)) / (doubled_area / base);
    const double first = along.x() - across.y();
    const double second = across.x() + along.y();
    return 0.25 * doubled_area * (first * first + second * second);
}

// Marks all edges of the triangles that carry most of the defect.
std::vector<char> edges_to_split(const ChartMap& map) {
    std::vector<double> defect(map.mesh.triangles.size());
    for (std::size_t t = 0; t < defect.size(); ++t) {
        defect[t] = conformal_defect(map, static_cast<int>(t));
    }
    std::vector<int> order(defect.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
        return defect[static_cast<std::size_t>(a)] > defect[static_cast<std::size_t>(b)];
    });
    double left = kSplitShare * std::accumulate(defect.begin(), defect.end(), 0.0);
    std::vector<char> marked(map.edges.from.size(), 0);
    for (const int t : order) {
        if (left <= 0.0) {
            break;
        }
        left -= defect[static_cast<std::size_t>(t)];
        std::fill_n(marked.begin() + 3 * static_cast<std::ptrdiff_t>(t), 3, char{1});
    }
    return marked;
}

}  // namespace

SolvedChart solve_resolved(ChartSurface surface,
                           const std::function<SolvedChart(const ChartSurface&)>& solve,
                           Refinement refinement,
                           const Context& context) {
    const int rounds = refinement == Refinement::Allowed ? kMostRounds : 0;
    for (int round = 0;; ++round) {
        SolvedChart solved = solve(surface);
        context.report("foliation", 0.9 * (1.0 - std::exp2(-(round + 1))));
        if (round >= rounds || !(solved.gap() > kWantedGap) ||
            surface.mesh.positions.size() >= kEnoughVertices) {
            return solved;
        }
        surface = split_edges(std::move(surface), edges_to_split(solved.map));
    }
}

}  // namespace leafcutter::geometry
