#include "geometry/quads/half_sag.h"

#include <algorithm>
#include <cstddef>

#include <Eigen/Geometry>

namespace leafcutter::geometry {

namespace {

using Eigen::Vector3d;

// A chord that spans a quarter of a circle has a sag of 0.21 of its length; with more it is no
// chord any more and half a sag no cure.
constexpr double kLargestSagOfEdge = 0.25;

struct Quad {
    Vector3d a;
    Vector3d b;
    Vector3d c;
    Vector3d d;

    Vector3d vector_area() const { return 0.5 * (c - a).cross(d - b); }
};

Quad quad_at(const std::vector<Vector3d>& vertices, const std::array<int, 4>& corners) {
    return {.a = vertices[static_cast<std::size_t>(corners[0])],
            .b = vertices[static_cast<std::size_t>(corners[1])],
            .c = vertices[static_cast<std::size_t>(corners[2])],
            .d = vertices[static_cast<std::size_t>(corners[3])]};
}

Vector3d sag_of(const Quad& quad, const Vector3d& surface_centre) {
    const Vector3d normal = quad.vector_area().normalized();
    const double sag = normal.dot(surface_centre - 0.25 * (quad.a + quad.b + quad.c + quad.d));
    const double edge = std::sqrt(quad.vector_area().norm());
    return std::abs(sag) <= kLargestSagOfEdge * edge ? Vector3d(sag * normal) : Vector3d::Zero();
}

}  // namespace

bool is_inverted(const std::vector<Vector3d>& vertices,
                 const std::array<int, 4>& corners,
                 const Vector3d& surface_vector_area) {
    return quad_at(vertices, corners).vector_area().dot(surface_vector_area) < 0.0;
}

void offset_by_half_sag(std::vector<Vector3d>& vertices, std::span<const SagCell> cells) {
    std::vector<Vector3d> offsets(vertices.size(), Vector3d::Zero());
    std::vector<int> counts(vertices.size(), 0);
    for (const SagCell& cell : cells) {
        const Vector3d sag = sag_of(quad_at(vertices, cell.corners), cell.surface_centre);
        for (const int corner : cell.corners) {
            offsets[static_cast<std::size_t>(corner)] += sag;
            ++counts[static_cast<std::size_t>(corner)];
        }
    }
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        offsets[v] *= counts[v] > 0 ? 0.5 / counts[v] : 0.0;
    }
    const std::vector<Vector3d> on_surface = vertices;
    // Every round that goes on takes at least one vertex back, so this ends.
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t v = 0; v < vertices.size(); ++v) {
            vertices[v] = on_surface[v] + offsets[v];
        }
        for (const SagCell& cell : cells) {
            if (!is_inverted(vertices, cell.corners, cell.surface_vector_area)) {
                continue;
            }
            for (const int corner : cell.corners) {
                Vector3d& offset = offsets[static_cast<std::size_t>(corner)];
                changed = changed || !offset.isZero(0.0);
                offset.setZero();
            }
        }
    }
}

}  // namespace leafcutter::geometry
