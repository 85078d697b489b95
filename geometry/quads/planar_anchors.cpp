#include "geometry/quads/planar_anchors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "geometry/parallel.h"
#include "geometry/quads/quad_edges.h"

namespace leafcutter::geometry {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kHeight = 2.0;
constexpr double kBoundary = 2.0;
constexpr double kStay = 0.02;

// Beside thin cells, places count against their width: that many times it.
constexpr double kThinCells = 3.0;

// What lies further than this beside the nearest point, in cells, lies beyond the surface's end.
constexpr double kBeyond = 0.05;

// A boundary that turns by more has a corner there.
constexpr double kCornerCosine = 0.6;

// How many pieces of the boundary on each side are looked at for the nearest one.
constexpr int kPiecesAround = 3;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

std::vector<double> sizes_at_vertices(const QuadMesh& mesh) {
    std::vector<double> sum(mesh.vertices.size(), 0.0);
    std::vector<int> count(mesh.vertices.size(), 0);
    for (const auto& quad : mesh.quads) {
        for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t from = at(quad[i]);
            const std::size_t to = at(quad[(i + 1) % 4]);
            const double length = (mesh.vertices[to] - mesh.vertices[from]).norm();
            for (const std::size_t end : {from, to}) {
                sum[end] += length;
                ++count[end];
            }
        }
    }
    for (std::size_t v = 0; v < sum.size(); ++v) {
        sum[v] = sum[v] > 0.0 ? sum[v] / count[v] : 1.0;
    }
    return sum;
}

}  // namespace

PlanarAnchors::PlanarAnchors(const QuadMesh& mesh, const TriangleMesh& surface)
    : triangles_(surface),
      closest_(surface),
      size_(sizes_at_vertices(mesh)),
      shortest_(size_),
      height_(mesh.vertices.size(), 0.0),
      feet_(mesh.vertices.size()),
      held_(mesh.vertices.size()),
      start_(mesh.vertices.size()),
      sides_(mesh.vertices.size()),
      corner_(mesh.vertices.size(), 0),
      segment_(mesh.vertices.size(), -1),
      origin_(mesh.vertices) {
    for (const auto& quad : mesh.quads) {
        for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t from = at(quad[i]);
            const std::size_t to = at(quad[(i + 1) % 4]);
            const double length = (mesh.vertices[to] - mesh.vertices[from]).norm();
            shortest_[from] = std::min(shortest_[from], length);
            shortest_[to] = std::min(shortest_[to], length);
        }
    }
    for (std::size_t v = 0; v < size_.size(); ++v) {
        size_[v] = std::min(size_[v], kThinCells * shortest_[v]);
        size_[v] = size_[v] > 0.0 ? size_[v] : 1.0;
    }
    find_boundary(mesh);
    int near = -1;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        feet_[v] = foot_of(mesh.vertices[v], near);
        near = feet_[v].triangle;
        height_[v] = feet_[v].normal.dot(mesh.vertices[v] - feet_[v].point);
        start_[v].weight = Matrix3d::Identity() * (kStay * kStay / (size_[v] * size_[v]));
        start_[v].place = mesh.vertices[v];
    }
}

void PlanarAnchors::find_boundary(const QuadMesh& mesh) {
    const QuadNeighbours neighbours = find_neighbours(mesh.quads);
    std::vector<int> cells(mesh.vertices.size(), 0);
    for (std::size_t quad = 0; quad < mesh.quads.size(); ++quad) {
        for (std::size_t i = 0; i < 4; ++i) {
            const int from = mesh.quads[quad][i];
            const int to = mesh.quads[quad][(i + 1) % 4];
            ++cells[at(from)];
            if (neighbours.across[quad][i].quad >= 0 || from == to) {
                continue;
            }
            // Where boundaries touch, the vertex stays.
            if (sides_[at(from)].after >= 0) {
                corner_[at(from)] = 1;
            }
            if (sides_[at(to)].before >= 0) {
                corner_[at(to)] = 1;
            }
            sides_[at(from)].after = to;
            sides_[at(to)].before = from;
        }
    }
    for (std::size_t v = 0; v < sides_.size(); ++v) {
        const auto [before, after] = sides_[v];
        if (before < 0 || after < 0) {
            corner_[v] = static_cast<char>(before >= 0 || after >= 0);
            continue;
        }
        const Vector3d in = origin_[v] - origin_[at(before)];
        const Vector3d out = origin_[at(after)] - origin_[v];
        const bool turns = in.dot(out) < kCornerCosine * in.norm() * out.norm();
        if (turns || cells[v] == 1) {
            corner_[v] = 1;
        }
        segment_[v] = static_cast<int>(v);
    }
}

PlanarAnchors::Foot PlanarAnchors::foot_of(const Vector3d& point, int near) const {
    const ClosestPoint::Hit hit = closest_.query(point, near);
    const auto& [a, b, c] = triangles_.triangles[at(hit.triangle)];
    const Vector3d& origin = triangles_.positions[at(a)];
    return {.point = hit.point,
            .normal = (triangles_.positions[at(b)] - origin)
                          .cross(triangles_.positions[at(c)] - origin)
                          .stableNormalized(),
            .triangle = hit.triangle};
}

Vector3d PlanarAnchors::normal_at(const Vector3d& point) const {
    return foot_of(point, -1).normal;
}

void PlanarAnchors::hold_to_boundary(std::size_t vertex, const Vector3d& position) {
    const double strength = kBoundary * kBoundary / (size_[vertex] * size_[vertex]);
    Anchor& anchor = held_[vertex];
    if (corner_[vertex] != 0) {
        anchor = {.weight = strength * Matrix3d::Identity(), .place = origin_[vertex]};
        return;
    }
    int begin = segment_[vertex];
    for (int i = 0; i < kPiecesAround && corner_[at(begin)] == 0; ++i) {
        begin = sides_[at(begin)].before;
    }
    double nearest = -1.0;
    for (int i = 0; i <= 2 * kPiecesAround && sides_[at(begin)].after >= 0; ++i) {
        const Vector3d& from = origin_[at(begin)];
        const Vector3d along = origin_[at(sides_[at(begin)].after)] - from;
        const double t = std::clamp(
            (position - from).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
        const Vector3d foot = from + t * along;
        const double distance = (position - foot).norm();
        if (nearest < 0.0 || distance < nearest) {
            nearest = distance;
            segment_[vertex] = begin;
            const Vector3d tangent = along.stableNormalized();
            anchor.weight = strength * (Matrix3d::Identity() - tangent * tangent.transpose());
            anchor.place = foot;
        }
        begin = sides_[at(begin)].after;
        if (corner_[at(begin)] != 0) {
            break;
        }
    }
}

void PlanarAnchors::update(const std::vector<Vector3d>& vertices, const Context& context) {
    for_each_index(vertices.size(), context, [&](std::size_t v) {
        if (sides_[v].boundary() || sides_[v].after >= 0) {
            hold_to_boundary(v, vertices[v]);
            return;
        }
        const Foot foot = foot_of(vertices[v], feet_[v].triangle);
        // The far side of a thin part is no place for it.
        if (foot.normal.dot(feet_[v].normal) > 0.0) {
            feet_[v] = foot;
        }
        const Vector3d& normal = feet_[v].normal;
        const Vector3d away = vertices[v] - feet_[v].point;
        const double aside = (away - normal.dot(away) * normal).norm();
        const double strength = kHeight * kHeight / (size_[v] * size_[v]);
        held_[v].place = feet_[v].point + height_[v] * normal;
        held_[v].weight = strength * normal * normal.transpose();
        if (aside > kBeyond * size_[v]) {
            held_[v].weight = strength * Matrix3d::Identity();
        }
    });
}

}  // namespace leafcutter::geometry
