#include "geometry/pants/prepare_surface.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "geometry/harmonic/chart_surface.h"
#include "geometry/loops/user_loops.h"

namespace leafcutter::geometry {
namespace {

// Coarser surfaces are split first: the map is linear on triangles.
constexpr std::size_t kLeastVertices = 3000;
// Loops of fewer vertices are split, with all triangles at them.
constexpr std::size_t kLeastLoopVertices = 16;
constexpr int kMostRounds = 6;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Per vertex the number of its boundary loop, or -1. Loop k goes through loops[k].front().
struct LoopNumbers {
    std::vector<int> of_vertex;
    std::vector<std::size_t> size;
};

LoopNumbers number_loops(const ChartSurface& surface, const std::vector<std::vector<int>>& loops) {
    std::vector<int> next(surface.mesh.positions.size(), -1);
    for (int h = 0; h < surface.edges.size(); ++h) {
        if (surface.edges.twin_of(h) < 0) {
            next[at(surface.edges.from_of(h))] = surface.edges.to_of(h);
        }
    }
    LoopNumbers numbers{std::vector<int>(next.size(), -1), {}};
    for (std::size_t k = 0; k < loops.size(); ++k) {
        numbers.size.push_back(0);
        for (int v = loops[k].front(); numbers.of_vertex[at(v)] < 0; v = next[at(v)]) {
            numbers.of_vertex[at(v)] = static_cast<int>(k);
            ++numbers.size.back();
        }
    }
    return numbers;
}

// Marks all edges of the triangles that touch a loop of too few vertices. Empty if there is none.
std::vector<char> edges_at_small_loops(const ChartSurface& surface, const LoopNumbers& loops) {
    const auto is_small = [&](int v) {
        const int loop = loops.of_vertex[at(v)];
        return loop >= 0 && loops.size[at(loop)] < kLeastLoopVertices;
    };
    std::vector<char> marked(surface.edges.from.size(), 0);
    bool any = false;
    for (std::size_t t = 0; t < surface.mesh.triangles.size(); ++t) {
        const auto& triangle = surface.mesh.triangles[t];
        if (std::any_of(triangle.begin(), triangle.end(), is_small)) {
            std::fill_n(marked.begin() + 3 * static_cast<std::ptrdiff_t>(t), 3, char{1});
            any = true;
        }
    }
    return any ? marked : std::vector<char>{};
}

ChartSurface refine(const TriangleMesh& mesh,
                    const std::vector<std::vector<int>>& loops,
                    Refinement refinement) {
    std::vector<std::uint8_t> on_boundary(mesh.positions.size(), 0);
    for (const std::vector<int>& loop : loops) {
        for (const int v : loop) {
            on_boundary[at(v)] = 1;
        }
    }
    ChartSurface surface = start_surface(mesh, std::move(on_boundary));
    for (int round = 0; round < kMostRounds && refinement == Refinement::Allowed; ++round) {
        std::vector<char> marked = edges_at_small_loops(surface, number_loops(surface, loops));
        if (surface.mesh.positions.size() < kLeastVertices) {
            marked.assign(surface.edges.from.size(), 1);
        }
        if (marked.empty()) {
            break;
        }
        surface = split_edges(std::move(surface), marked);
    }
    return surface;
}

// Edges between vertices of lines that are not the lines' own.
std::vector<char> chords(const ChartSurface& surface,
                         const std::vector<int>& line_of_vertex,
                         const std::vector<std::vector<int>>& cuts) {
    std::vector<int> next_on_cut(line_of_vertex.size(), -1);
    for (const std::vector<int>& cut : cuts) {
        for (std::size_t i = 0; i < cut.size(); ++i) {
            next_on_cut[at(cut[i])] = cut[(i + 1) % cut.size()];
        }
    }
    std::vector<char> marked(surface.edges.from.size(), 0);
    for (int h = 0; h < surface.edges.size(); ++h) {
        const int a = surface.edges.from_of(h);
        const int b = surface.edges.to_of(h);
        const bool own =
            surface.edges.twin_of(h) < 0 || next_on_cut[at(a)] == b || next_on_cut[at(b)] == a;
        marked[at(h)] = !own && line_of_vertex[at(a)] >= 0 && line_of_vertex[at(b)] >= 0 ? 1 : 0;
    }
    return marked;
}

}  // namespace

PreparedSurface prepare_surface(const TriangleMesh& mesh,
                                const std::vector<std::vector<int>>& boundary_loops,
                                const std::vector<std::vector<int>>& cuts,
                                Refinement refinement,
                                const Context& context) {
    ChartSurface surface = refine(mesh, boundary_loops, refinement);
    std::vector<int> lines = number_loops(surface, boundary_loops).of_vertex;
    std::vector<std::vector<int>> closed;
    if (!cuts.empty()) {
        closed = close_loops(build_vertex_rings(surface.edges, static_cast<int>(lines.size())),
                             surface.mesh.positions, cuts, context);
    }
    int line = static_cast<int>(boundary_loops.size());
    for (const std::vector<int>& cut : closed) {
        for (const int v : cut) {
            lines[at(v)] = line;
        }
        ++line;
    }
    surface = split_edges(std::move(surface), chords(surface, lines, closed));
    lines.resize(surface.mesh.positions.size(), -1);
    PreparedSurface prepared;
    prepared.surface = {std::move(surface.mesh), std::move(lines)};
    prepared.boundary_lines = static_cast<int>(boundary_loops.size());
    prepared.cut_lines = static_cast<int>(closed.size());
    return prepared;
}

}  // namespace leafcutter::geometry
