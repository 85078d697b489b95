// The paper's measures once more, word by word from the definitions and as slowly as can be:
// nothing is shared with what it checks.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "geometry/quads/quad_mesh.h"
#include "geometry/types.h"

namespace leafcutter::testing {

using Eigen::Vector3d;

struct BruteQuality {
    std::vector<double> angle_deviation_deg;           // Per vertex with quads, by number.
    std::vector<double> crossing_angle_deviation_deg;  // Per regular vertex.
    std::vector<double> distance;                      // Per quad, as all that follow.
    std::vector<double> distance_percent;
    std::vector<double> area_percent;
    std::vector<double> planarity_percent;
};

inline double mean_of(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) {
        sum += value;
    }
    return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

inline double max_of(const std::vector<double>& values) {
    return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

// By the normal equations inside, else by the sides.
inline Vector3d brute_closest(const Vector3d& p, const std::array<Vector3d, 3>& t) {
    Eigen::Matrix<double, 3, 2> sides;
    sides << t[1] - t[0], t[2] - t[0];
    const Eigen::Vector2d place = sides.colPivHouseholderQr().solve(p - t[0]);
    if (place.minCoeff() >= 0.0 && place.sum() <= 1.0) {
        return t[0] + sides * place;
    }
    Vector3d best = t[0];
    for (std::size_t i = 0; i < 3; ++i) {
        const Vector3d side = t[(i + 1) % 3] - t[i];
        const double s = std::min(1.0, std::max(0.0, (p - t[i]).dot(side) / side.dot(side)));
        const Vector3d found = t[i] + s * side;
        best = (found - p).norm() < (best - p).norm() ? found : best;
    }
    return best;
}

inline Vector3d brute_closest(const Vector3d& p, const geometry::TriangleMesh& surface) {
    Vector3d best = Vector3d::Constant(std::numeric_limits<double>::infinity());
    for (const auto& [a, b, c] : surface.triangles) {
        const auto& at = surface.positions;
        const Vector3d found =
            brute_closest(p, {at[std::size_t(a)], at[std::size_t(b)], at[std::size_t(c)]});
        best = (found - p).norm() < (best - p).norm() || !best.allFinite() ? found : best;
    }
    return best;
}

// By Heron's rule.
inline double brute_area(const Vector3d& p, const Vector3d& q, const Vector3d& r) {
    const double a = (p - q).norm();
    const double b = (q - r).norm();
    const double c = (r - p).norm();
    const double s = 0.5 * (a + b + c);
    return std::sqrt(std::max(0.0, s * (s - a) * (s - b) * (s - c)));
}

// By the law of cosines.
inline double brute_angle_deg(const Vector3d& at, const Vector3d& one, const Vector3d& other) {
    const double a = (one - at).norm();
    const double b = (other - at).norm();
    const double c = (one - other).norm();
    return std::acos(std::clamp((a * a + b * b - c * c) / (2 * a * b), -1.0, 1.0)) * 180.0 /
           std::numbers::pi;
}

// Shortest way between two lines, by its two feet.
inline double brute_line_gap(const std::array<Vector3d, 2>& one,
                             const std::array<Vector3d, 2>& other) {
    const Vector3d u = one[1] - one[0];
    const Vector3d v = other[1] - other[0];
    Eigen::Matrix<double, 3, 2> system;
    system << u, -v;
    const Eigen::Vector2d place = system.colPivHouseholderQr().solve(other[0] - one[0]);
    return (one[0] + place[0] * u - other[0] - place[1] * v).norm();
}

// Of meshes whose leaves are rows and columns of one cylinder: neither torus nor pillowcase.
inline BruteQuality brute_quality(const geometry::QuadMesh& mesh,
                                  const geometry::TriangleMesh& surface,
                                  int samples = 7) {
    BruteQuality quality;
    std::map<int, std::vector<double>> corners;
    std::map<int, std::array<std::set<int>, 2>> weft_neighbours;  // Before, after.
    std::map<int, std::array<std::set<int>, 2>> warp_neighbours;
    std::map<std::pair<int, int>, double> row_length;
    std::map<std::pair<int, int>, double> col_length;
    const auto at = [&mesh](int v) -> const Vector3d& { return mesh.vertices[std::size_t(v)]; };
    for (std::size_t q = 0; q < mesh.quads.size(); ++q) {
        const auto& [a, b, c, d] = mesh.quads[q];
        corners[a].push_back(brute_angle_deg(at(a), at(b), at(d)));
        corners[b].push_back(brute_angle_deg(at(b), at(a), at(c)));
        corners[c].push_back(brute_angle_deg(at(c), at(b), at(d)));
        corners[d].push_back(brute_angle_deg(at(d), at(c), at(a)));
        for (const auto& [from, to] : {std::pair{a, b}, std::pair{d, c}}) {
            weft_neighbours[to][0].insert(from);
            weft_neighbours[from][1].insert(to);
        }
        for (const auto& [from, to] : {std::pair{a, d}, std::pair{b, c}}) {
            warp_neighbours[to][0].insert(from);
            warp_neighbours[from][1].insert(to);
        }
        const geometry::QuadAddress& address = mesh.addresses[q];
        row_length[{address.cylinder, address.row}] +=
            0.5 * ((at(a) - at(b)).norm() + (at(c) - at(d)).norm());
        col_length[{address.cylinder, address.col}] +=
            0.5 * ((at(a) - at(d)).norm() + (at(c) - at(b)).norm());
    }
    for (const auto& [vertex, angles] : corners) {
        std::vector<double> off;
        for (const double angle : angles) {
            off.push_back(std::abs(angle - 90.0));
        }
        quality.angle_deviation_deg.push_back(mean_of(off));
        const auto& weft = weft_neighbours[vertex];
        const auto& warp = warp_neighbours[vertex];
        if (weft[0].size() == 1 && weft[1].size() == 1 && warp[0].size() == 1 &&
            warp[1].size() == 1) {
            const Vector3d along = at(*weft[1].begin()) - at(*weft[0].begin());
            const Vector3d across = at(*warp[1].begin()) - at(*warp[0].begin());
            quality.crossing_angle_deviation_deg.push_back(
                std::abs(brute_angle_deg(Vector3d::Zero(), along, across) - 90.0));
        }
    }
    for (std::size_t q = 0; q < mesh.quads.size(); ++q) {
        const auto& [a, b, c, d] = mesh.quads[q];
        std::vector<std::vector<Vector3d>> feet;
        double largest = 0.0;
        for (int i = 0; i < samples; ++i) {
            feet.emplace_back();
            for (int j = 0; j < samples; ++j) {
                const double v = double(i) / (samples - 1);
                const double u = double(j) / (samples - 1);
                const Vector3d low = at(a) + u * (at(b) - at(a));
                const Vector3d high = at(d) + u * (at(c) - at(d));
                const Vector3d point = low + v * (high - low);
                feet.back().push_back(brute_closest(point, surface));
                largest = std::max(largest, (feet.back().back() - point).norm());
            }
        }
        double projected = 0.0;
        for (std::size_t i = 0; i + 1 < feet.size(); ++i) {
            for (std::size_t j = 0; j + 1 < feet.size(); ++j) {
                projected += brute_area(feet[i][j], feet[i][j + 1], feet[i + 1][j + 1]) +
                             brute_area(feet[i][j], feet[i + 1][j + 1], feet[i + 1][j]);
            }
        }
        const double area = brute_area(at(a), at(b), at(c)) + brute_area(at(a), at(c), at(d));
        const geometry::QuadAddress& address = mesh.addresses[q];
        const double leaves = 0.5 * (row_length.at({address.cylinder, address.row}) +
                                     col_length.at({address.cylinder, address.col}));
        const double diagonals = 0.5 * ((at(a) - at(c)).norm() + (at(b) - at(d)).norm());
        quality.distance.push_back(largest);
        quality.distance_percent.push_back(100.0 * largest / leaves);
        quality.area_percent.push_back(100.0 * std::abs(area - projected) / projected);
        quality.planarity_percent.push_back(100.0 * brute_line_gap({at(a), at(c)}, {at(b), at(d)}) /
                                            diagonals);
    }
    return quality;
}

}  // namespace leafcutter::testing
