#include "geometry/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <queue>
#include <utility>

#include <Eigen/Geometry>

namespace leafcutter::geometry {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// A vertex whose distance is known.
struct Known {
    const Eigen::Vector3d& position;
    double distance;
};

// The distance of `target` from a source that is as far from `a` and `b` as they say, if the way
// leads through the edge between them; else infinite.
double through_edge(const Known& a, const Known& b, const Eigen::Vector3d& target) {
    const Eigen::Vector3d ab = b.position - a.position;
    const double length = ab.norm();
    const Eigen::Vector3d at_target = target - a.position;
    if (!(length > 0.0)) {
        return kFar;
    }
    // In the triangle's plane: a at (0, 0), b at (length, 0), target above, source below.
    const double target_x = at_target.dot(ab) / length;
    const double target_y = at_target.cross(ab).norm() / length;
    const double source_x =
        0.5 * (length + (a.distance - b.distance) * (a.distance + b.distance) / length);
    const double square = a.distance * a.distance - source_x * source_x;
    if (square < 0.0) {
        return kFar;
    }
    const double source_y = std::sqrt(square);
    const double height = target_y + source_y;
    const double crossing =
        height > 0.0 ? source_x + (target_x - source_x) * source_y / height : source_x;
    if (crossing < 0.0 || crossing > length) {
        return kFar;
    }
    return std::hypot(target_x - source_x, height);
}

}  // namespace

struct SurfaceDistance::Front {
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    std::vector<int> touched;
};

SurfaceDistance::SurfaceDistance(const TriangleMesh& mesh)
    : mesh_(mesh),
      begin_(mesh.positions.size() + 1, 0),
      triangles_(3 * mesh.triangles.size()),
      distance_(mesh.positions.size(), kFar),
      is_final_(mesh.positions.size(), 0) {
    for (const auto& triangle : mesh.triangles) {
        for (const int v : triangle) {
            ++begin_[at(v) + 1];
        }
    }
    for (std::size_t v = 1; v < begin_.size(); ++v) {
        begin_[v] += begin_[v - 1];
    }
    std::vector<int> cursor(begin_.begin(), begin_.end() - 1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (const int v : mesh.triangles[t]) {
            triangles_[at(cursor[at(v)]++)] = static_cast<int>(t);
        }
    }
}

std::span<const int> SurfaceDistance::triangles_of(int vertex) const {
    const std::size_t begin = at(begin_[at(vertex)]);
    return std::span(triangles_).subspan(begin, at(begin_[at(vertex) + 1]) - begin);
}

// Shortens the ways to the other two corners of a triangle.
void SurfaceDistance::relax(const Reached& at_vertex, int triangle, Front& front) {
    const auto& corners = mesh_.triangles[at(triangle)];
    std::size_t k = 0;
    while (corners[k] != at_vertex.vertex) {
        ++k;
    }
    const Known here{mesh_.positions[at(at_vertex.vertex)], at_vertex.distance};
    const std::array<int, 2> others{corners[(k + 1) % 3], corners[(k + 2) % 3]};
    for (std::size_t i = 0; i < 2; ++i) {
        const int v = others[i];
        const int third = others[1 - i];
        if (is_final_[at(v)] != 0) {
            continue;
        }
        double reached = here.distance + (mesh_.positions[at(v)] - here.position).norm();
        if (is_final_[at(third)] != 0) {
            const Known other{mesh_.positions[at(third)], distance_[at(third)]};
            reached = std::min(reached, through_edge(here, other, mesh_.positions[at(v)]));
        }
        // The unfolded source may seem nearer than the front where the surface is bent.
        reached = std::max(reached, here.distance);
        if (reached < distance_[at(v)]) {
            if (distance_[at(v)] == kFar) {
                front.touched.push_back(v);
            }
            distance_[at(v)] = reached;
            front.queue.emplace(reached, v);
        }
    }
}

std::vector<SurfaceDistance::Reached> SurfaceDistance::from(
    std::span<const int> sources, const std::function<bool(const Reached&)>& go_on) {
    std::vector<Reached> reached;
    Front front;
    for (const int v : sources) {
        if (distance_[at(v)] != 0.0) {
            distance_[at(v)] = 0.0;
            front.touched.push_back(v);
            front.queue.emplace(0.0, v);
        }
    }
    while (!front.queue.empty()) {
        const auto [distance, v] = front.queue.top();
        front.queue.pop();
        if (is_final_[at(v)] != 0) {
            continue;
        }
        is_final_[at(v)] = 1;
        reached.push_back({v, distance});
        if (go_on && !go_on(reached.back())) {
            continue;
        }
        for (const int triangle : triangles_of(v)) {
            relax(reached.back(), triangle, front);
        }
    }
    for (const int v : front.touched) {
        distance_[at(v)] = kFar;
        is_final_[at(v)] = 0;
    }
    return reached;
}

double distance_inside(const std::array<Eigen::Vector3d, 3>& corners,
                       const std::array<double, 3>& distances,
                       const Eigen::Vector3d& point) {
    double reached = kFar;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        reached = std::min(
            {reached, distances[k] + (corners[k] - point).norm(),
             through_edge({corners[k], distances[k]}, {corners[next], distances[next]}, point)});
    }
    return reached;
}

}  // namespace leafcutter::geometry
