#include "geometry/topology.h"

#include <cstddef>

namespace leafcutter::geometry {

namespace {

// Numbers the components in the order of their first faces; returns how many.
int number_components(const Mesh& mesh, std::vector<int>& component_of_face) {
    component_of_face.assign(mesh.n_faces(), -1);
    int components = 0;
    std::vector<Mesh::FaceHandle> waiting;
    for (const Mesh::FaceHandle first : mesh.faces()) {
        if (component_of_face[static_cast<std::size_t>(first.idx())] >= 0) {
            continue;
        }
        component_of_face[static_cast<std::size_t>(first.idx())] = components;
        waiting.push_back(first);
        while (!waiting.empty()) {
            const Mesh::FaceHandle face = waiting.back();
            waiting.pop_back();
            for (const Mesh::FaceHandle other : mesh.ff_range(face)) {
                int& component = component_of_face[static_cast<std::size_t>(other.idx())];
                if (component < 0) {
                    component = components;
                    waiting.push_back(other);
                }
            }
        }
        ++components;
    }
    return components;
}

// The boundary half-edges have the surface on their other side, to the right: a loop is walked
// against them, so that the surface lies to the left.
std::vector<std::vector<int>> boundary_loops(const Mesh& mesh) {
    std::vector<std::vector<int>> loops;
    std::vector<char> visited(mesh.n_halfedges(), 0);
    for (const Mesh::HalfedgeHandle first : mesh.halfedges()) {
        if (!mesh.is_boundary(first) || visited[static_cast<std::size_t>(first.idx())] != 0) {
            continue;
        }
        std::vector<int>& loop = loops.emplace_back();
        Mesh::HalfedgeHandle at = first;
        do {
            visited[static_cast<std::size_t>(at.idx())] = 1;
            loop.push_back(mesh.to_vertex_handle(at).idx());
            at = mesh.prev_halfedge_handle(at);
        } while (at != first);
    }
    return loops;
}

}  // namespace

Topology analyse_topology(const Mesh& mesh) {
    Topology topology;
    topology.vertices = static_cast<int>(mesh.n_vertices());
    topology.edges = static_cast<int>(mesh.n_edges());
    topology.faces = static_cast<int>(mesh.n_faces());
    topology.components = number_components(mesh, topology.component_of_face);
    topology.boundary_loops = boundary_loops(mesh);
    topology.euler = topology.vertices - topology.edges + topology.faces;
    // Each component has chi = 2 - 2 genus - loops; the sum over components solves for the genus.
    const int loops = static_cast<int>(topology.boundary_loops.size());
    topology.genus = (2 * topology.components - loops - topology.euler) / 2;
    return topology;
}

TriangleMesh to_triangle_mesh(const Mesh& mesh) {
    TriangleMesh result;
    result.positions.reserve(mesh.n_vertices());
    for (const Mesh::VertexHandle vertex : mesh.vertices()) {
        result.positions.push_back(mesh.point(vertex));
    }
    result.triangles.reserve(mesh.n_faces());
    for (const Mesh::FaceHandle face : mesh.faces()) {
        // A face's own half-edge ends at the corner it was added with first.
        const Mesh::HalfedgeHandle side = mesh.halfedge_handle(face);
        const Mesh::HalfedgeHandle next = mesh.next_halfedge_handle(side);
        result.triangles.push_back({mesh.to_vertex_handle(side).idx(),
                                    mesh.to_vertex_handle(next).idx(),
                                    mesh.from_vertex_handle(side).idx()});
    }
    return result;
}

}  // namespace leafcutter::geometry
