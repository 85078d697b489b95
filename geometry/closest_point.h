// Closest points on a triangle mesh, by a bounding volume hierarchy. Exact, thread-safe to query.

#pragma once

#include <memory>

#include <Eigen/Core>

#include "geometry/types.h"

namespace leafcutter::geometry {

class ClosestPoint {
public:
    // Keeps its own copy of what it needs. O(n log n).
    explicit ClosestPoint(const TriangleMesh& mesh);
    ~ClosestPoint();
    ClosestPoint(ClosestPoint&&) noexcept;
    ClosestPoint& operator=(ClosestPoint&&) noexcept;

    struct Hit {
        Eigen::Vector3d point;
        double distance = 0.0;
        int triangle = -1;
    };
    // The mesh has at least one triangle.
    Hit query(const Eigen::Vector3d& point) const;

    // The same, faster where `near_triangle` (the hit of a point close by; -1: none) is near.
    Hit query(const Eigen::Vector3d& point, int near_triangle) const;

    double total_area() const;
    double diagonal() const;  // Of the bounding box.

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace leafcutter::geometry
