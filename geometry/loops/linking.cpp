#include "geometry/loops/linking.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/Geometry>

namespace leafcutter::geometry {
namespace {

// How far lines are pushed off the surface, by the shortest edge at the vertex.
constexpr double kPush = 1e-3;
// Turns of a vertex normal towards the face it leans from most, where a face doesn't see it.
constexpr int kNormalTurns = 50;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

using Polyline = std::vector<Eigen::Vector3d>;

// Directions of sight without a relation to anything a model could have.
const std::array<Eigen::Vector3d, 3>& sights() {
    static const std::array<Eigen::Vector3d, 3> all{Eigen::Vector3d(0.3719, 0.5831, 0.7223),
                                                    Eigen::Vector3d(-0.6971, 0.2287, 0.6795),
                                                    Eigen::Vector3d(0.1373, -0.8191, 0.5570)};
    return all;
}

// Rotates space so that the sight runs along z.
Polyline seen_along(const Eigen::Vector3d& sight, std::span<const Eigen::Vector3d> line) {
    const Eigen::Matrix3d turn =
        Eigen::Quaterniond::FromTwoVectors(sight, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    Polyline seen;
    seen.reserve(line.size());
    for (const Eigen::Vector3d& p : line) {
        seen.emplace_back(turn * p);
    }
    return seen;
}

double cross2(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

struct Crossings {
    int over = 0;  // Signed crossings of the first line over the second,
    int under = 0;
};

void count_crossing(const Eigen::Vector3d& a,
                    const Eigen::Vector3d& along_a,
                    const Eigen::Vector3d& b,
                    const Eigen::Vector3d& along_b,
                    Crossings& crossings) {
    const double side = cross2(along_a, along_b);
    const Eigen::Vector3d apart = b - a;
    const double s = cross2(apart, along_b);  // Over `side`: where on the first segment,
    const double t = cross2(apart, along_a);  // and where on the second.
    const double sign = side < 0.0 ? -1.0 : 1.0;
    const double size = std::abs(side);
    if (size == 0.0 || sign * s < 0.0 || sign * s >= size || sign * t < 0.0 || sign * t >= size) {
        return;
    }
    const double height = a.z() + s / side * along_a.z() - b.z() - t / side * along_b.z();
    (height > 0.0 ? crossings.over : crossings.under) += side < 0.0 ? -1 : 1;
}

Crossings count_crossings(const Polyline& a, const Polyline& b) {
    Crossings crossings;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Eigen::Vector3d& p = a[i];
        const Eigen::Vector3d along = a[(i + 1) % a.size()] - p;
        const double left = p.x() + std::min(along.x(), 0.0);
        const double right = p.x() + std::max(along.x(), 0.0);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const Eigen::Vector3d& q = b[j];
            const Eigen::Vector3d& r = b[j + 1 < b.size() ? j + 1 : 0];
            if (std::max(q.x(), r.x()) >= left && std::min(q.x(), r.x()) <= right) {
                count_crossing(p, along, q, r - q, crossings);
            }
        }
    }
    return crossings;
}

// A direction that all given face normals see, if the mean of them can be turned into one.
Eigen::Vector3d seen_by_all(const std::vector<Eigen::Vector3d>& normals, Eigen::Vector3d mean) {
    for (int turn = 0; turn < kNormalTurns; ++turn) {
        mean.normalize();
        const auto worst = std::min_element(
            normals.begin(), normals.end(),
            [&](const auto& a, const auto& b) { return a.dot(mean) < b.dot(mean); });
        if (worst == normals.end() || worst->dot(mean) > 0.1) {
            break;
        }
        mean += 0.5 * *worst;
    }
    return mean.normalized();
}

}  // namespace

std::optional<int> linking_number(std::span<const Eigen::Vector3d> a,
                                  std::span<const Eigen::Vector3d> b) {
    for (const Eigen::Vector3d& sight : sights()) {
        const Crossings crossings = count_crossings(seen_along(sight, a), seen_along(sight, b));
        if (crossings.over == -crossings.under) {
            return crossings.over;
        }
    }
    return std::nullopt;
}

std::vector<Eigen::Vector3d> pushed_out(std::span<const std::array<int, 3>> triangles,
                                        std::span<const Eigen::Vector3d> positions) {
    std::vector<std::vector<Eigen::Vector3d>> normals(positions.size());
    std::vector<Eigen::Vector3d> mean(positions.size(), Eigen::Vector3d::Zero());
    std::vector<double> shortest(positions.size(), std::numeric_limits<double>::infinity());
    for (const auto& t : triangles) {
        const Eigen::Vector3d& a = positions[at(t[0])];
        const Eigen::Vector3d normal =
            (positions[at(t[1])] - a).cross(positions[at(t[2])] - a).normalized();
        for (std::size_t k = 0; k < 3; ++k) {
            const Eigen::Vector3d& p = positions[at(t[k])];
            const Eigen::Vector3d to_next = positions[at(t[(k + 1) % 3])] - p;
            const Eigen::Vector3d to_last = positions[at(t[(k + 2) % 3])] - p;
            const double angle = std::atan2(to_next.cross(to_last).norm(), to_next.dot(to_last));
            normals[at(t[k])].push_back(normal);
            mean[at(t[k])] += angle * normal;
            shortest[at(t[k])] = std::min({shortest[at(t[k])], to_next.norm(), to_last.norm()});
        }
    }
    std::vector<Eigen::Vector3d> outside;
    for (std::size_t v = 0; v < positions.size(); ++v) {
        outside.emplace_back(positions[v] + kPush * shortest[v] * seen_by_all(normals[v], mean[v]));
    }
    return outside;
}

std::optional<IntegerMatrix> linking_matrix(std::span<const std::vector<int>> cycles,
                                            std::span<const Eigen::Vector3d> positions,
                                            std::span<const Eigen::Vector3d> outside) {
    const auto line = [](const std::vector<int>& cycle, std::span<const Eigen::Vector3d> places) {
        Polyline polyline;
        for (const int v : cycle) {
            polyline.push_back(places[at(v)]);
        }
        return polyline;
    };
    const auto count = static_cast<Eigen::Index>(cycles.size());
    IntegerMatrix matrix(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const Polyline on = line(cycles[static_cast<std::size_t>(i)], positions);
        for (Eigen::Index j = 0; j < count; ++j) {
            const auto number =
                linking_number(on, line(cycles[static_cast<std::size_t>(j)], outside));
            if (!number) {
                return std::nullopt;
            }
            matrix(i, j) = *number;
        }
    }
    return matrix;
}

}  // namespace leafcutter::geometry
