#include "fab/parts.h"

#include <algorithm>
#include <cstddef>

#include <Eigen/Geometry>

namespace leafcutter::fab {

namespace {

using geometry::Mesh;
using geometry::Topology;

std::vector<int> part_of_vertices(const Mesh& mesh, const Topology& topology) {
    std::vector<int> part(mesh.n_vertices(), -1);
    for (const Mesh::FaceHandle face : mesh.faces()) {
        for (const Mesh::VertexHandle vertex : mesh.fv_range(face)) {
            part[static_cast<std::size_t>(vertex.idx())] =
                topology.component_of_face[static_cast<std::size_t>(face.idx())];
        }
    }
    return part;
}

double area_of(const Mesh& mesh, Mesh::FaceHandle face) {
    const Mesh::HalfedgeHandle side = mesh.halfedge_handle(face);
    const Eigen::Vector3d& a = mesh.point(mesh.from_vertex_handle(side));
    const Eigen::Vector3d& b = mesh.point(mesh.to_vertex_handle(side));
    const Eigen::Vector3d& c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(side)));
    return 0.5 * (b - a).cross(c - a).norm();
}

}  // namespace

std::vector<Part> parts_of(const Mesh& mesh, const Topology& topology) {
    std::vector<Part> parts(static_cast<std::size_t>(topology.components));
    const std::vector<int> part_of_vertex = part_of_vertices(mesh, topology);
    for (const int part : part_of_vertex) {
        if (part >= 0) {
            ++parts[static_cast<std::size_t>(part)].vertices;
        }
    }
    for (const Mesh::FaceHandle face : mesh.faces()) {
        const int component = topology.component_of_face[static_cast<std::size_t>(face.idx())];
        Part& part = parts[static_cast<std::size_t>(component)];
        ++part.faces;
        part.area += area_of(mesh, face);
    }
    std::vector<int> sides(parts.size(), 0);  // On the boundary.
    for (std::size_t i = 0; i < topology.boundary_loops.size(); ++i) {
        const std::vector<int>& loop = topology.boundary_loops[i];
        const auto part =
            static_cast<std::size_t>(part_of_vertex[static_cast<std::size_t>(loop.front())]);
        parts[part].boundary_loops.push_back(static_cast<int>(i));
        sides[part] += static_cast<int>(loop.size());
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
        // Each edge has two sides in all, those of the boundary one of them in a face.
        const int edges = (3 * parts[i].faces + sides[i]) / 2;
        parts[i].euler = parts[i].vertices - edges + parts[i].faces;
        const int loops = static_cast<int>(parts[i].boundary_loops.size());
        parts[i].genus = (2 - loops - parts[i].euler) / 2;
    }
    return parts;
}

void assign_cylinders(const Mesh& mesh,
                      const Topology& topology,
                      const std::vector<geometry::Cylinder>& cylinders,
                      std::vector<Part>& parts) {
    const std::vector<int> part_of_vertex = part_of_vertices(mesh, topology);
    for (std::size_t i = 0; i < cylinders.size(); ++i) {
        const std::vector<int>& sources = cylinders[i].source_vertex;
        const auto known =
            std::find_if(sources.begin(), sources.end(), [](int vertex) { return vertex >= 0; });
        if (known != sources.end()) {
            const int part = part_of_vertex[static_cast<std::size_t>(*known)];
            parts[static_cast<std::size_t>(part)].cylinders.push_back(static_cast<int>(i));
        }
    }
}

}  // namespace leafcutter::fab
