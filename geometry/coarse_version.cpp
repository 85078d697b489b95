#include "geometry/coarse_version.h"

#include <numeric>
#include <utility>

#include "geometry/half_edges.h"
#include "geometry/pants/level.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// The number of the boundary loop through each vertex, or -1.
std::vector<int> loops_of_vertices(const TriangleMesh& mesh) {
    const HalfEdges edges =
        build_half_edges(mesh.triangles, static_cast<int>(mesh.positions.size()));
    std::vector<int> next(mesh.positions.size(), -1);
    for (int h = 0; h < edges.size(); ++h) {
        if (edges.twin_of(h) < 0) {
            next[at(edges.from_of(h))] = edges.to_of(h);
        }
    }
    std::vector<int> loop(mesh.positions.size(), -1);
    int loops = 0;
    for (std::size_t first = 0; first < next.size(); ++first) {
        if (next[first] < 0 || loop[first] >= 0) {
            continue;
        }
        for (int v = static_cast<int>(first); loop[at(v)] < 0; v = next[at(v)]) {
            loop[at(v)] = loops;
        }
        ++loops;
    }
    return loop;
}

}  // namespace

CoarseVersion coarse_version(const TriangleMesh& mesh, std::size_t most, const Context& context) {
    CoarseVersion out;
    if (mesh.positions.size() <= most) {
        out.mesh = mesh;
        out.source_vertex.resize(mesh.positions.size());
        std::iota(out.source_vertex.begin(), out.source_vertex.end(), 0);
        return out;
    }
    CoarsenOptions options;
    options.target_vertices = most;
    Coarser coarser = coarsen({mesh, loops_of_vertices(mesh)}, options, context);
    out.mesh = std::move(coarser.surface.mesh);
    out.source_vertex.assign(out.mesh.positions.size(), -1);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const int representative = coarser.representative[v];
        if (mesh.positions[v] == out.mesh.positions[at(representative)] &&
            out.source_vertex[at(representative)] < 0) {
            out.source_vertex[at(representative)] = static_cast<int>(v);
        }
    }
    return out;
}

}  // namespace leafcutter::geometry
