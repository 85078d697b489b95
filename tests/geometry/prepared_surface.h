// Surfaces with all that the pants decomposition asks for, and a few of higher genus by formula.

#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/half_edges.h"
#include "geometry/implicit_surface.h"
#include "geometry/io/read_mesh.h"
#include "geometry/laplacian.h"
#include "geometry/pants/decomposition.h"
#include "geometry/repair.h"
#include "geometry/topology.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::testing {

// Owns what a DecompositionSurface borrows.
class PreparedSurface {
public:
    explicit PreparedSurface(TriangleMesh given) : mesh(std::move(given)) {
        using namespace geometry;
        const int count = static_cast<int>(mesh.positions.size());
        half_edges = build_half_edges(mesh.triangles, count);
        rings = build_vertex_rings(half_edges, count);
        for (const WeightedEdge& edge : positive_edges(mesh, half_edges, 1e-3)) {
            weights.push_back(edge.weight);
        }
        const Topology topology = analyse_topology(to_mesh(mesh));
        loops = topology.boundary_loops;
        genus = topology.genus;
    }

    geometry::DecompositionSurface view(std::vector<std::vector<int>> cuts = {}) const {
        return {mesh.triangles, mesh.positions, rings, weights, loops, std::move(cuts)};
    }

    TriangleMesh mesh;
    geometry::HalfEdges half_edges;
    geometry::VertexRings rings;
    std::vector<double> weights;
    std::vector<std::vector<int>> loops;
    int genus = 0;
};

inline double ring_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& centre) {
    const Eigen::Vector3d q = p - centre;
    return std::hypot(std::hypot(q.x(), q.y()) - 1.0, q.z()) - 0.35;
}

// `genus` rings in a row, melted together.
inline TriangleMesh make_chain_of_rings(int genus, int faces) {
    const double length = 2.2 * (genus - 1);
    const auto value = [=](const Eigen::Vector3d& p) {
        double sum = 0.0;
        for (int k = 0; k < genus; ++k) {
            const Eigen::Vector3d centre(2.2 * k - 0.5 * length, 0.0, 0.0);
            sum += std::exp(-12.0 * ring_distance(p, centre));
        }
        return -std::log(sum) / 12.0;
    };
    const double half = 0.5 * length + 1.7;
    return geometry::mesh_implicit_surface({value, {-half, -1.7, -0.7}, {half, 1.7, 0.7}, 0.2},
                                           faces);
}

// A tube about a trefoil knot.
inline TriangleMesh make_trefoil_tube(double radius) {
    using std::numbers::pi;
    const auto knot = [](double a) {
        return Eigen::Vector3d(std::sin(a) + 2.0 * std::sin(2.0 * a),
                               std::cos(a) - 2.0 * std::cos(2.0 * a), -std::sin(3.0 * a));
    };
    return make_grid(
        {.across = 12,
         .along = 160,
         .closed_across = true,
         .closed_along = true,
         .position = [=](double u, double v) {
             const double a = 2.0 * pi * v;
             const double step = 1e-4;
             const Eigen::Vector3d along = (knot(a + step) - knot(a - step)).normalized();
             const Eigen::Vector3d bend = knot(a + step) - 2.0 * knot(a) + knot(a - step);
             const Eigen::Vector3d side = (bend - along.dot(bend) * along).normalized();
             const double turn = 2.0 * pi * u;
             return Eigen::Vector3d(
                 knot(a) + radius * (std::cos(turn) * side + std::sin(turn) * along.cross(side)));
         }});
}

// A mesh of the shared data, if there is any.
inline std::optional<TriangleMesh> read_shared(const std::string& name) {
    using namespace geometry;
    const auto path = std::filesystem::path(LEAFCUTTER_SHARED_DIR) / "data" / "meshes" / name;
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        return std::nullopt;
    }
    const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
    return to_triangle_mesh(repair(read_mesh(std::as_bytes(std::span(bytes)), name)).mesh);
}

}  // namespace leafcutter::testing
