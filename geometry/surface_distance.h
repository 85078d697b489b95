// Lengths of shortest paths across a triangle surface, from one vertex or several.
//
// Dijkstra's order with an update through triangles: the source is unfolded into the plane of each
// triangle, as in exact window propagation, but only one source per edge is kept. Exact on flat
// parts, a little too long elsewhere.

#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/types.h"

namespace leafcutter::geometry {

class SurfaceDistance {
public:
    struct Reached {
        int vertex = 0;
        double distance = 0.0;  // In units of the mesh.
    };

    // Keeps the mesh by reference.
    explicit SurfaceDistance(const TriangleMesh& mesh);

    // Vertices in rising order of distance. The front goes on from those alone for which `go_on`
    // says so (all, if it is empty).
    std::vector<Reached> from(std::span<const int> sources,
                              const std::function<bool(const Reached&)>& go_on = {});

    // Triangles round a vertex.
    std::span<const int> triangles_of(int vertex) const;

private:
    struct Front;
    void relax(const Reached& at_vertex, int triangle, Front& front);

    const TriangleMesh& mesh_;
    std::vector<int> begin_;
    std::vector<int> triangles_;
    std::vector<double> distance_;  // Infinite between calls.
    std::vector<char> is_final_;    // 0 between calls.
};

// The distance of a point of a triangle whose corners' distances from one source are known.
double distance_inside(const std::array<Eigen::Vector3d, 3>& corners,
                       const std::array<double, 3>& distances,
                       const Eigen::Vector3d& point);

}  // namespace leafcutter::geometry
