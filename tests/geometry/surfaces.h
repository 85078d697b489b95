// Triangle meshes by formula, kind and nasty ones, for tests that need a surface but no file.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "geometry/mesh.h"
#include "geometry/types.h"

namespace leafcutter::testing {

using geometry::Mesh;
using geometry::TriangleMesh;

inline std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

inline Mesh to_mesh(const TriangleMesh& triangles) {
    Mesh mesh;
    std::vector<Mesh::VertexHandle> handles;
    for (const Eigen::Vector3d& position : triangles.positions) {
        handles.push_back(mesh.add_vertex(position));
    }
    for (const auto& t : triangles.triangles) {
        mesh.add_face(handles[at(t[0])], handles[at(t[1])], handles[at(t[2])]);
    }
    return mesh;
}

// A grid of cells, each cut by a diagonal. (u, v) in [0, 1]; u x v points outward.
struct GridForm {
    int across = 16;
    int along = 16;
    bool closed_across = false;
    bool closed_along = false;
    std::function<Eigen::Vector3d(double, double)> position;
    bool random_diagonals = false;
    unsigned seed = 1;
};

inline TriangleMesh make_grid(const GridForm& form) {
    TriangleMesh mesh;
    const int cols = form.across + (form.closed_across ? 0 : 1);
    const int rows = form.along + (form.closed_along ? 0 : 1);
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < cols; ++i) {
            mesh.positions.push_back(form.position(static_cast<double>(i) / form.across,
                                                   static_cast<double>(j) / form.along));
        }
    }
    std::minstd_rand random(form.seed);
    const auto vertex = [&](int i, int j) { return (j % rows) * cols + i % cols; };
    for (int j = 0; j < form.along; ++j) {
        for (int i = 0; i < form.across; ++i) {
            const std::array<int, 4> q{vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1),
                                       vertex(i, j + 1)};
            if (form.random_diagonals && random() % 2 == 0) {
                mesh.triangles.push_back({q[0], q[1], q[3]});
                mesh.triangles.push_back({q[1], q[2], q[3]});
            } else {
                mesh.triangles.push_back({q[0], q[1], q[2]});
                mesh.triangles.push_back({q[0], q[2], q[3]});
            }
        }
    }
    return mesh;
}

inline TriangleMesh make_square(int cells) {
    return make_grid({.across = cells, .along = cells, .position = [](double u, double v) {
                          return Eigen::Vector3d(u, v, 0.0);
                      }});
}

// A prism without ends: `across` flat sides, inscribed in a circle.
inline TriangleMesh make_prism(int across, int along, double radius, double height) {
    return make_grid({.across = across,
                      .along = along,
                      .closed_across = true,
                      .position = [=](double u, double v) {
                          const double angle = 2.0 * std::numbers::pi * u;
                          return Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle),
                                                 height * v);
                      }});
}

// A flat ring between two circles.
inline TriangleMesh make_ring(int across, int along, double inner, double outer) {
    return make_grid({.across = across,
                      .along = along,
                      .closed_across = true,
                      .position = [=](double u, double v) {
                          // From the outside inwards, so that the normal points up.
                          const double radius = outer * std::pow(inner / outer, v);
                          const double angle = 2.0 * std::numbers::pi * u;
                          return Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle),
                                                 0.0);
                      }});
}

// Radius 1 to the middle of a tube of radius `tube`; u runs round the tube.
inline TriangleMesh make_torus(int across, int along, double tube) {
    return make_grid({.across = across,
                      .along = along,
                      .closed_across = true,
                      .closed_along = true,
                      .position = [=](double u, double v) {
                          const double a = 2.0 * std::numbers::pi * u;
                          const double b = -2.0 * std::numbers::pi * v;
                          const double radius = 1.0 + tube * std::cos(a);
                          return Eigen::Vector3d(radius * std::cos(b), radius * std::sin(b),
                                                 tube * std::sin(a));
                      }});
}

// A square plate out of whose middle a closed finger grows, `length` long and 0.2 thick. The
// finger's grid is square rings, so all is one grid.
inline TriangleMesh make_finger(int cells, double length) {
    return make_grid(
        {.across = cells, .along = cells, .position = [=](double u, double v) -> Eigen::Vector3d {
             const Eigen::Vector2d p(2.0 * u - 1.0, 2.0 * v - 1.0);
             const double ring = p.cwiseAbs().maxCoeff();  // 0 at the middle, 1 at the border.
             if (ring == 0.0) {
                 return {0.0, 0.0, length + 0.1};
             }
             const Eigen::Vector2d direction = p / ring;  // On the unit square's border.
             const Eigen::Vector2d round = direction.normalized();
             if (ring > 0.6) {
                 const double t = (ring - 0.6) / 0.4;
                 const Eigen::Vector2d q = (1.0 - t) * 0.1 * round + t * direction;
                 return {q.x(), q.y(), 0.0};
             }
             if (ring > 0.1) {
                 return {0.1 * round.x(), 0.1 * round.y(), length * (0.6 - ring) / 0.5};
             }
             const double angle = ring / 0.1 * std::numbers::pi / 2.0;
             return {0.1 * std::sin(angle) * round.x(), 0.1 * std::sin(angle) * round.y(),
                     length + 0.1 * std::cos(angle)};
         }});
}

// Puts new vertices into random triangles, most of them very near a corner or an edge.
inline void add_needles(TriangleMesh& mesh, int count, std::minstd_rand& random) {
    std::uniform_real_distribution<double> exponent(-7.0, 0.0);
    for (int k = 0; k < count; ++k) {
        const std::size_t t = random() % mesh.triangles.size();
        const std::array<int, 3> old = mesh.triangles[t];
        Eigen::Vector3d weight(std::pow(10.0, exponent(random)), std::pow(10.0, exponent(random)),
                               std::pow(10.0, exponent(random)));
        weight /= weight.sum();
        mesh.positions.emplace_back(weight[0] * mesh.positions[at(old[0])] +
                                    weight[1] * mesh.positions[at(old[1])] +
                                    weight[2] * mesh.positions[at(old[2])]);
        const int v = static_cast<int>(mesh.positions.size()) - 1;
        mesh.triangles[t] = {old[0], old[1], v};
        mesh.triangles.push_back({old[1], old[2], v});
        mesh.triangles.push_back({old[2], old[0], v});
    }
}

// Moves every vertex by up to `most` in each direction.
inline void jitter(TriangleMesh& mesh, double most, std::minstd_rand& random) {
    std::uniform_real_distribution<double> offset(-most, most);
    for (Eigen::Vector3d& position : mesh.positions) {
        position += Eigen::Vector3d(offset(random), offset(random), offset(random));
    }
}

// The same surface with its vertices numbered backwards and its triangles in backward order.
inline TriangleMesh renumbered(const TriangleMesh& mesh) {
    TriangleMesh out;
    out.positions.assign(mesh.positions.rbegin(), mesh.positions.rend());
    const int last = static_cast<int>(mesh.positions.size()) - 1;
    for (auto t = mesh.triangles.rbegin(); t != mesh.triangles.rend(); ++t) {
        out.triangles.push_back({last - (*t)[1], last - (*t)[2], last - (*t)[0]});
    }
    return out;
}

}  // namespace leafcutter::testing
