#include "geometry/cases/corners.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

constexpr double kWindow = 1.0 / 40.0;         // Half width of the smoothing, in loop lengths.
constexpr double kLeastDistance = 1.0 / 10.0;  // Between two corners, in loop lengths.
constexpr double kLeastTurning = 25.0 * std::numbers::pi / 180.0;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// pi less the sum of the triangle angles at each vertex of the loop, in radians.
std::vector<double> geodesic_turning(const TriangleMesh& mesh, std::span<const int> loop) {
    std::vector<int> place(mesh.positions.size(), -1);
    for (std::size_t i = 0; i < loop.size(); ++i) {
        place[at(loop[i])] = static_cast<int>(i);
    }
    std::vector<double> turning(loop.size(), std::numbers::pi);
    for (const auto& triangle : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (place[at(triangle[k])] < 0) {
                continue;
            }
            const Eigen::Vector3d& apex = mesh.positions[at(triangle[k])];
            const Eigen::Vector3d a = mesh.positions[at(triangle[(k + 1) % 3])] - apex;
            const Eigen::Vector3d b = mesh.positions[at(triangle[(k + 2) % 3])] - apex;
            turning[at(place[at(triangle[k])])] -= std::atan2(a.cross(b).norm(), a.dot(b));
        }
    }
    return turning;
}

// Sum of the turning near each vertex, weighted by a triangular window over the arc length.
std::vector<double> smoothed(const std::vector<double>& turning, const std::vector<double>& arc) {
    const std::size_t n = turning.size();
    const double whole = arc.back();
    const double radius = kWindow * whole;
    std::vector<double> out(turning);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t step = 1; step < n; ++step) {
            const std::size_t j = (i + step) % n;
            const double distance = arc[j] - arc[i] + (j < i ? whole : 0.0);
            if (distance >= radius) {
                break;
            }
            const double weight = 1.0 - distance / radius;
            out[i] += weight * turning[j];
            out[j] += weight * turning[i];
        }
    }
    return out;
}

double loop_distance(const std::vector<double>& arc, int a, int b) {
    const double forward = std::abs(arc[at(a)] - arc[at(b)]);
    return std::min(forward, arc.back() - forward);
}

std::optional<LoopCorners> corners_by_turning(const std::vector<double>& turning,
                                              const std::vector<double>& arc) {
    std::vector<int> order(turning.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return turning[at(a)] > turning[at(b)]; });
    std::vector<int> chosen;
    for (const int candidate : order) {
        if (chosen.size() == 4 || turning[at(candidate)] < kLeastTurning) {
            break;
        }
        if (std::all_of(chosen.begin(), chosen.end(), [&](int other) {
                return loop_distance(arc, candidate, other) >= kLeastDistance * arc.back();
            })) {
            chosen.push_back(candidate);
        }
    }
    if (chosen.size() < 4) {
        return std::nullopt;
    }
    std::sort(chosen.begin(), chosen.end());
    return LoopCorners{chosen[0], chosen[1], chosen[2], chosen[3]};
}

int nearest_vertex(const std::vector<double>& arc, double position) {
    const double wrapped = std::fmod(position, arc.back());
    const auto after = std::lower_bound(arc.begin(), arc.end(), wrapped);
    auto index = after - arc.begin();
    if (index > 0 && wrapped - arc[at(static_cast<int>(index) - 1)] < *after - wrapped) {
        --index;
    }
    return static_cast<int>(index) % (static_cast<int>(arc.size()) - 1);
}

bool all_different(const LoopCorners& sorted) {
    return std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
}

LoopCorners corners_by_equal_arcs(const std::vector<double>& turning,
                                  const std::vector<double>& arc) {
    const int n = static_cast<int>(turning.size());
    // Where edges are so uneven that arcs have no vertex of their own: equal counts.
    LoopCorners best{0, n / 4, n / 2, 3 * n / 4};
    double most = -std::numeric_limits<double>::infinity();
    for (int phase = 0; phase < n; ++phase) {
        LoopCorners corners{};
        for (int k = 0; k < 4; ++k) {
            corners[at(k)] = nearest_vertex(arc, arc[at(phase)] + 0.25 * k * arc.back());
        }
        std::sort(corners.begin(), corners.end());
        double sum = 0.0;
        for (const int corner : corners) {
            sum += turning[at(corner)];
        }
        if (all_different(corners) && sum > most) {
            most = sum;
            best = corners;
        }
    }
    return best;
}

}  // namespace

std::vector<double> arc_lengths(const TriangleMesh& mesh, std::span<const int> loop) {
    std::vector<double> arc{0.0};
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Eigen::Vector3d& a = mesh.positions[at(loop[i])];
        const Eigen::Vector3d& b = mesh.positions[at(loop[(i + 1) % loop.size()])];
        arc.push_back(arc.back() + (b - a).norm());
    }
    return arc;
}

LoopCorners choose_corners(const TriangleMesh& mesh, std::span<const int> loop) {
    const std::vector<double> arc = arc_lengths(mesh, loop);
    const std::vector<double> turning = smoothed(geodesic_turning(mesh, loop), arc);
    const auto corners = corners_by_turning(turning, arc);
    return corners ? *corners : corners_by_equal_arcs(turning, arc);
}

LoopCorners locate_corners(std::span<const int> loop, const std::array<int, 4>& vertices) {
    LoopCorners corners{};
    for (std::size_t k = 0; k < 4; ++k) {
        const auto found = std::find(loop.begin(), loop.end(), vertices[k]);
        if (found == loop.end()) {
            throw Error(ErrorKind::BadOption, "bad-corners",
                        "foliation.corners: vertex " + std::to_string(vertices[k]) +
                            " is not on the boundary; give four vertices of the boundary loop");
        }
        corners[k] = static_cast<int>(found - loop.begin());
    }
    std::sort(corners.begin(), corners.end());
    if (!all_different(corners)) {
        throw Error(ErrorKind::BadOption, "bad-corners",
                    "foliation.corners: a vertex is given twice; give four different vertices");
    }
    return corners;
}

}  // namespace leafcutter::geometry
