// Loop's subdivision: every triangle becomes four, the limit surface is smooth. For tests and
// benchmarks that need one surface at several sizes.
//
// C. Loop, "Smooth subdivision surfaces based on triangles", 1987; boundaries as cubic splines.

#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Core>

#include "geometry/half_edges.h"
#include "geometry/types.h"

namespace leafcutter::testing {

// Closed surfaces and surfaces with boundary; the given vertices come first, in their order.
inline geometry::TriangleMesh subdivide_loop(const geometry::TriangleMesh& mesh) {
    using Eigen::Vector3d;
    using geometry::HalfEdges;
    const std::size_t count = mesh.positions.size();
    const HalfEdges edges = geometry::build_half_edges(mesh.triangles, static_cast<int>(count));
    const auto position = [&](int v) { return mesh.positions[static_cast<std::size_t>(v)]; };
    const auto apex = [&](int h) { return position(edges.from_of(HalfEdges::previous(h))); };

    geometry::TriangleMesh out;
    std::vector<Vector3d> ring(count, Vector3d::Zero());  // Sum of neighbours ...
    std::vector<int> valence(count, 0);
    std::vector<Vector3d> rim(count, Vector3d::Zero());  // ... and of those along the boundary.
    std::vector<char> on_rim(count, 0);
    out.positions.resize(count);
    std::vector<int> middle(static_cast<std::size_t>(edges.size()), -1);
    for (int h = 0; h < edges.size(); ++h) {
        if (!edges.is_first(h)) {
            continue;
        }
        const int a = edges.from_of(h);
        const int b = edges.to_of(h);
        const int twin = edges.twin_of(h);
        middle[static_cast<std::size_t>(h)] = static_cast<int>(out.positions.size());
        Vector3d point = 0.5 * (position(a) + position(b));
        if (twin >= 0) {
            middle[static_cast<std::size_t>(twin)] = static_cast<int>(out.positions.size());
            point = 0.75 * point + 0.125 * (apex(h) + apex(twin));
        }
        out.positions.push_back(point);
        for (const auto& [v, w] : {std::pair{a, b}, std::pair{b, a}}) {
            const auto i = static_cast<std::size_t>(v);
            ring[i] += position(w);
            ++valence[i];
            if (twin < 0) {
                rim[i] += position(w);
                on_rim[i] = 1;
            }
        }
    }
    for (std::size_t v = 0; v < count; ++v) {
        const Vector3d& old = mesh.positions[v];
        if (on_rim[v] != 0) {
            out.positions[v] = 0.75 * old + 0.125 * rim[v];
            continue;
        }
        const double n = valence[v];
        const double c = 0.375 + 0.25 * std::cos(2.0 * std::numbers::pi / n);
        const double share = 0.625 - c * c;
        out.positions[v] = (1.0 - share) * old + share / n * ring[v];
    }
    for (int t = 0; t < edges.size(); t += 3) {
        const std::array<int, 3> v{edges.from_of(t), edges.from_of(t + 1), edges.from_of(t + 2)};
        const std::array<int, 3> m{middle[static_cast<std::size_t>(t)],
                                   middle[static_cast<std::size_t>(t) + 1],
                                   middle[static_cast<std::size_t>(t) + 2]};
        out.triangles.push_back({v[0], m[0], m[2]});
        out.triangles.push_back({v[1], m[1], m[0]});
        out.triangles.push_back({v[2], m[2], m[1]});
        out.triangles.push_back(m);
    }
    return out;
}

}  // namespace leafcutter::testing
