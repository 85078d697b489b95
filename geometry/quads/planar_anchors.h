// What holds the vertices of a quad mesh to its surface while they move.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/closest_point.h"
#include "geometry/context.h"
#include "geometry/quads/quad_mesh.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

// The energy of a vertex x is (x − place)ᵀ weight (x − place), a sum of two of them.
struct Anchor {
    Eigen::Matrix3d weight = Eigen::Matrix3d::Zero();
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
};

// Vertices stay at the height over the surface where they were, and may slide in it; those of
// the boundary may slide along it; its corners stay. All a little towards their start.
class PlanarAnchors {
public:
    // Keeps references to both.
    PlanarAnchors(const QuadMesh& mesh, const TriangleMesh& surface);

    // Looks up anew where the vertices are. Vertices without a cell get weight only.
    void update(const std::vector<Eigen::Vector3d>& vertices, const Context& context);

    const Anchor& held(std::size_t vertex) const { return held_[vertex]; }
    const Anchor& start(std::size_t vertex) const { return start_[vertex]; }

    // Mean length of the sides at the vertex, at the start.
    double size(std::size_t vertex) const { return size_[vertex]; }

    // Length of the shortest of them.
    double shortest_side(std::size_t vertex) const { return shortest_[vertex]; }

    // Along the surface's normal, at the closest point.
    Eigen::Vector3d normal_at(const Eigen::Vector3d& point) const;
    const ClosestPoint& surface() const { return closest_; }

private:
    struct Foot {
        Eigen::Vector3d point = Eigen::Vector3d::Zero();
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        int triangle = -1;
    };
    void find_boundary(const QuadMesh& mesh);
    Foot foot_of(const Eigen::Vector3d& point, int near) const;
    void hold_to_boundary(std::size_t vertex, const Eigen::Vector3d& at);

    const TriangleMesh& triangles_;
    ClosestPoint closest_;
    std::vector<double> size_;
    std::vector<double> shortest_;
    std::vector<double> height_;  // Over the surface, at the start.
    std::vector<Foot> feet_;
    std::vector<Anchor> held_;
    std::vector<Anchor> start_;

    // Per vertex: the boundary vertices before and after it, -1 inside; itself: a corner.
    struct Sides {
        int before = -1;
        int after = -1;
        bool boundary() const { return before >= 0; }
    };
    std::vector<Sides> sides_;
    std::vector<char> corner_;
    std::vector<int> segment_;  // Per boundary vertex: the one that begins the nearest piece.
    std::vector<Eigen::Vector3d> origin_;
};

}  // namespace leafcutter::geometry
