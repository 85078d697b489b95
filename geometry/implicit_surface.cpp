// Marching tetrahedra (A. Doi, A. Koide, "An efficient method of triangulating equi-valued surfaces
// by using tetrahedral cells", 1991) find the topology; M. Botsch, L. Kobbelt, "A Remeshing
// Approach to Multiresolution Modeling", SGP 2004 (section 4) makes the triangles even: split long
// edges, collapse short ones, flip towards valence 6, relax along the surface and project back onto
// it.

#include "geometry/implicit_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/mesh.h"
#include "geometry/topology.h"

namespace leafcutter::geometry {

namespace {

Eigen::Vector3d gradient(const ImplicitSurface& surface, const Eigen::Vector3d& p) {
    const double step = 1e-4 * surface.finest_detail;
    Eigen::Vector3d result;
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d offset = step * Eigen::Vector3d::Unit(axis);
        result[axis] = (surface.value(p + offset) - surface.value(p - offset)) / (2.0 * step);
    }
    return result;
}

// ---- Marching tetrahedra

class March {
public:
    March(const ImplicitSurface& surface, double cell);
    Mesh run();

private:
    using Node = std::uint32_t;
    Node node(const Eigen::Array3i& at) const {
        return static_cast<Node>((at.z() * nodes_.y() + at.y()) * nodes_.x() + at.x());
    }
    Eigen::Vector3d position(Node node) const;
    void march_cell(const Eigen::Array3i& at);
    void march_tetrahedron(const std::array<Node, 4>& corners);
    Mesh::VertexHandle crossing(Node inside, Node outside);
    void add_triangle(std::array<Mesh::VertexHandle, 3> corners, const Eigen::Vector3d& outward);

    const ImplicitSurface& surface_;
    double cell_;
    Eigen::Array3i nodes_;
    std::vector<double> values_;
    std::unordered_map<std::uint64_t, Mesh::VertexHandle> crossings_;  // By the two nodes.
    Mesh mesh_;
};

March::March(const ImplicitSurface& surface, double cell) : surface_(surface), cell_(cell) {
    nodes_ = ((surface.high - surface.low) / cell).array().ceil().cast<int>() + 1;
    values_.resize(static_cast<std::size_t>(nodes_.cast<long>().prod()));
    for (Node n = 0; n < values_.size(); ++n) {
        values_[n] = surface.value(position(n));
    }
}

Eigen::Vector3d March::position(Node node) const {
    const auto columns = static_cast<Node>(nodes_.x());
    const auto rows = static_cast<Node>(nodes_.y());
    const Node line = node / columns;
    const Node layer = line / rows;
    const Eigen::Vector3d steps(node % columns, line % rows, layer);
    return surface_.low + cell_ * steps;
}

Mesh::VertexHandle March::crossing(Node inside, Node outside) {
    const std::uint64_t key = (std::uint64_t{inside} << 32U) | outside;
    const auto [it, is_new] = crossings_.try_emplace(key);
    if (is_new) {
        // Clear of the nodes, so that no triangle has a side of length 0; projection comes later.
        constexpr double kMargin = 0.05;
        const double share = std::clamp(values_[inside] / (values_[inside] - values_[outside]),
                                        kMargin, 1 - kMargin);
        const Eigen::Vector3d point = position(inside) * (1 - share) + position(outside) * share;
        it->second = Mesh::VertexHandle(mesh_.add_vertex(point).idx());
    }
    return it->second;
}

void March::add_triangle(std::array<Mesh::VertexHandle, 3> corners,
                         const Eigen::Vector3d& outward) {
    const Eigen::Vector3d origin = mesh_.point(corners[0]);
    const Eigen::Vector3d normal =
        (mesh_.point(corners[1]) - origin).cross(mesh_.point(corners[2]) - origin);
    if (normal.dot(outward) < 0.0) {
        std::swap(corners[1], corners[2]);
    }
    mesh_.add_face(corners[0], corners[1], corners[2]);
}

void March::march_tetrahedron(const std::array<Node, 4>& corners) {
    std::vector<Node> inside;
    std::vector<Node> outside;
    Eigen::Vector3d outward = Eigen::Vector3d::Zero();
    for (const Node corner : corners) {
        (values_[corner] < 0.0 ? inside : outside).push_back(corner);
    }
    if (inside.empty() || outside.empty()) {
        return;
    }
    for (const Node in : inside) {
        for (const Node out : outside) {
            outward += position(out) - position(in);
        }
    }
    if (inside.size() == 2) {
        const auto a = crossing(inside[0], outside[0]);
        const auto b = crossing(inside[0], outside[1]);
        const auto c = crossing(inside[1], outside[1]);
        const auto d = crossing(inside[1], outside[0]);
        add_triangle({a, b, c}, outward);
        add_triangle({a, c, d}, outward);
        return;
    }
    std::array<Mesh::VertexHandle, 3> cut;
    for (std::size_t i = 0; i < 3; ++i) {
        cut[i] =
            inside.size() == 1 ? crossing(inside[0], outside[i]) : crossing(inside[i], outside[0]);
    }
    add_triangle(cut, outward);
}

// Six tetrahedra around the cell's diagonal, the same in each cell, so that neighbours match.
void March::march_cell(const Eigen::Array3i& at) {
    static constexpr std::array<std::array<int, 3>, 6> kAxisOrders{
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    for (const auto& order : kAxisOrders) {
        Eigen::Array3i corner = at;
        std::array<Node, 4> corners{node(corner), 0, 0, 0};
        for (std::size_t step = 0; step < 3; ++step) {
            ++corner[order[step]];
            corners[step + 1] = node(corner);
        }
        march_tetrahedron(corners);
    }
}

Mesh March::run() {
    for (int z = 0; z + 1 < nodes_.z(); ++z) {
        for (int y = 0; y + 1 < nodes_.y(); ++y) {
            for (int x = 0; x + 1 < nodes_.x(); ++x) {
                march_cell({x, y, z});
            }
        }
    }
    return std::move(mesh_);
}

// ---- Even triangles

class Remesher {
public:
    Remesher(const ImplicitSurface& surface, Mesh mesh)
        : surface_(surface), mesh_(std::move(mesh)) {
        mesh_.request_vertex_status();
        mesh_.request_edge_status();
        mesh_.request_halfedge_status();
        mesh_.request_face_status();
    }
    double area() const;
    void iterate(double edge_length);
    const Mesh& mesh() const { return mesh_; }

private:
    double length(Mesh::EdgeHandle edge) const { return mesh_.calc_edge_length(edge); }
    void split_long_edges(double longest);
    void collapse_short_edges(double shortest, double longest);
    bool may_collapse(Mesh::HalfedgeHandle edge, double longest);
    void flip_towards_regular();
    int valence_error(Mesh::VertexHandle vertex, int change) const;
    bool flip_keeps_normals(Mesh::EdgeHandle edge) const;
    void relax();
    Eigen::Vector3d relaxed(Mesh::VertexHandle vertex) const;
    Eigen::Vector3d projected(Eigen::Vector3d p, bool on_boundary) const;

    const ImplicitSurface& surface_;
    Mesh mesh_;
};

double Remesher::area() const {
    double sum = 0.0;
    for (const Mesh::FaceHandle face : mesh_.faces()) {
        sum += mesh_.calc_face_area(face);
    }
    return sum;
}

void Remesher::split_long_edges(double longest) {
    const auto edges = static_cast<unsigned>(mesh_.n_edges());  // New ones wait for the next round.
    for (unsigned index = 0; index < edges; ++index) {
        const Mesh::EdgeHandle edge = mesh_.edge_handle(index);
        if (length(edge) > longest) {
            const Mesh::VertexHandle middle(mesh_.add_vertex(mesh_.calc_edge_midpoint(edge)).idx());
            mesh_.split(edge, middle);
        }
    }
}

// Whether the half-edge's start may be merged into its end.
bool Remesher::may_collapse(Mesh::HalfedgeHandle edge, double longest) {
    const Mesh::VertexHandle from = mesh_.from_vertex_handle(edge);
    const Mesh::VertexHandle to = mesh_.to_vertex_handle(edge);
    if (mesh_.is_boundary(from) && !mesh_.is_boundary(mesh_.edge_handle(edge))) {
        return false;
    }
    const Eigen::Vector3d target = mesh_.point(to);
    for (const Mesh::HalfedgeHandle around : mesh_.voh_range(from)) {
        const auto a = mesh_.to_vertex_handle(around);
        if ((mesh_.point(a) - target).norm() > longest) {
            return false;
        }
        if (mesh_.is_boundary(around)) {
            continue;
        }
        const auto b = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(around));
        if (a == to || b == to) {
            continue;
        }
        const Eigen::Vector3d pa = mesh_.point(a);
        const Eigen::Vector3d side = mesh_.point(b) - pa;
        if (side.cross(mesh_.point(from) - pa).dot(side.cross(target - pa)) <= 0.0) {
            return false;  // A face would turn over.
        }
    }
    return mesh_.is_collapse_ok(edge);
}

void Remesher::collapse_short_edges(double shortest, double longest) {
    for (const Mesh::EdgeHandle edge : mesh_.all_edges()) {
        if (mesh_.status(edge).deleted() || length(edge) >= shortest) {
            continue;
        }
        for (const unsigned side : {0U, 1U}) {
            const Mesh::HalfedgeHandle half = mesh_.halfedge_handle(edge, side);
            if (may_collapse(half, longest)) {
                mesh_.collapse(half);
                break;
            }
        }
    }
    mesh_.garbage_collection();
}

int Remesher::valence_error(Mesh::VertexHandle vertex, int change) const {
    const int wanted = mesh_.is_boundary(vertex) ? 4 : 6;
    const int error = static_cast<int>(mesh_.valence(vertex)) + change - wanted;
    return error * error;
}

bool Remesher::flip_keeps_normals(Mesh::EdgeHandle edge) const {
    const Mesh::HalfedgeHandle half = mesh_.halfedge_handle(edge, 0);
    const Mesh::HalfedgeHandle other = mesh_.halfedge_handle(edge, 1);
    const Eigen::Vector3d a = mesh_.point(mesh_.from_vertex_handle(half));
    const Eigen::Vector3d b = mesh_.point(mesh_.to_vertex_handle(half));
    const Eigen::Vector3d c = mesh_.point(mesh_.opposite_vh(half));
    const Eigen::Vector3d d = mesh_.point(mesh_.opposite_vh(other));
    const Eigen::Vector3d normal = (b - a).cross(c - a) + (d - a).cross(b - a);
    return (d - c).cross(b - c).dot(normal) > 0.0 && (a - c).cross(d - c).dot(normal) > 0.0;
}

void Remesher::flip_towards_regular() {
    for (const Mesh::EdgeHandle edge : mesh_.edges()) {
        if (mesh_.is_boundary(edge) || !mesh_.is_flip_ok(edge)) {
            continue;
        }
        const Mesh::HalfedgeHandle half = mesh_.halfedge_handle(edge, 0);
        const std::array<Mesh::VertexHandle, 2> ends{mesh_.from_vertex_handle(half),
                                                     mesh_.to_vertex_handle(half)};
        const std::array<Mesh::VertexHandle, 2> tips{
            mesh_.opposite_vh(half), mesh_.opposite_vh(mesh_.halfedge_handle(edge, 1))};
        int before = 0;
        int after = 0;
        for (std::size_t i = 0; i < 2; ++i) {
            before += valence_error(ends[i], 0) + valence_error(tips[i], 0);
            after += valence_error(ends[i], -1) + valence_error(tips[i], 1);
        }
        if (after < before && flip_keeps_normals(edge)) {
            mesh_.flip(edge);
        }
    }
}

// The mean of the neighbours, moved in the tangent plane only; on a boundary, along it.
Eigen::Vector3d Remesher::relaxed(Mesh::VertexHandle vertex) const {
    const Eigen::Vector3d p = mesh_.point(vertex);
    const bool on_boundary = mesh_.is_boundary(vertex);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double count = 0.0;
    for (const Mesh::HalfedgeHandle around : mesh_.voh_range(vertex)) {
        if (!on_boundary || mesh_.is_boundary(mesh_.edge_handle(around))) {
            mean += mesh_.point(mesh_.to_vertex_handle(around));
            count += 1.0;
        }
    }
    mean /= count;
    Eigen::Vector3d normal = gradient(surface_, p);
    if (on_boundary) {
        normal.z() = 0.0;
    }
    normal.normalize();
    return mean + normal * normal.dot(p - mean);
}

// Newton steps along the gradient. The boundary stays in the plane it lies in.
Eigen::Vector3d Remesher::projected(Eigen::Vector3d p, bool on_boundary) const {
    constexpr int kSteps = 4;
    for (int step = 0; step < kSteps; ++step) {
        Eigen::Vector3d slope = gradient(surface_, p);
        if (on_boundary) {
            slope.z() = 0.0;
        }
        Eigen::Vector3d move = slope * (surface_.value(p) / slope.squaredNorm());
        const double longest = surface_.finest_detail;
        if (move.norm() > longest) {
            move *= longest / move.norm();
        }
        p -= move;
    }
    return p;
}

void Remesher::relax() {
    std::vector<Eigen::Vector3d> moved(mesh_.n_vertices());
    for (const Mesh::VertexHandle vertex : mesh_.vertices()) {
        moved[static_cast<std::size_t>(vertex.idx())] = relaxed(vertex);
    }
    for (const Mesh::VertexHandle vertex : mesh_.vertices()) {
        mesh_.set_point(vertex, projected(moved[static_cast<std::size_t>(vertex.idx())],
                                          mesh_.is_boundary(vertex)));
    }
}

void Remesher::iterate(double edge_length) {
    const double longest = 4.0 / 3.0 * edge_length;
    const double shortest = 4.0 / 5.0 * edge_length;
    split_long_edges(longest);
    collapse_short_edges(shortest, longest);
    flip_towards_regular();
    relax();
}

}  // namespace

TriangleMesh mesh_implicit_surface(const ImplicitSurface& surface, int faces) {
    constexpr double kCellsPerDetail = 2.0;
    constexpr int kIterations = 12;
    Remesher remesher(surface, March(surface, surface.finest_detail / kCellsPerDetail).run());
    for (int i = 0; i < kIterations; ++i) {
        const double equilateral_area = remesher.area() / faces;
        // The lengths that remeshing leaves are a little below the one asked for.
        constexpr double kLengthBias = 1.04;
        remesher.iterate(kLengthBias * std::sqrt(equilateral_area * 4.0 / std::sqrt(3.0)));
    }
    return to_triangle_mesh(remesher.mesh());
}

}  // namespace leafcutter::geometry
