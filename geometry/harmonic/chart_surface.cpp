#include "geometry/harmonic/chart_surface.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Adds a midpoint for each marked edge; returns it for both of its half-edges, -1 elsewhere.
std::vector<int> add_midpoints(ChartSurface& out, const std::vector<char>& marked) {
    const HalfEdges& edges = out.edges;
    std::vector<int> midpoint(edges.from.size(), -1);
    for (int h = 0; h < edges.size(); ++h) {
        const int twin = edges.twin_of(h);
        if (!edges.is_first(h) || (marked[at(h)] == 0 && (twin < 0 || marked[at(twin)] == 0))) {
            continue;
        }
        const int a = edges.from_of(h);
        const int b = edges.to_of(h);
        midpoint[at(h)] = static_cast<int>(out.mesh.positions.size());
        if (twin >= 0) {
            midpoint[at(twin)] = midpoint[at(h)];
        }
        out.mesh.positions.emplace_back(0.5 *
                                        (out.mesh.positions[at(a)] + out.mesh.positions[at(b)]));
        out.source_vertex.push_back(-1);
        const unsigned shared = out.lines[at(a)] & out.lines[at(b)];
        out.lines.push_back(static_cast<std::uint8_t>(twin < 0 ? shared : 0U));
    }
    return midpoint;
}

// The triangles that replace one with midpoints on some edges, turned so that the cases are few.
void append_pieces(std::vector<std::array<int, 3>>& out,
                   const std::array<int, 3>& triangle,
                   const std::array<int, 3>& midpoints) {
    std::size_t k =
        0;  // First corner so that edge k is split and edge k + 2 isn't, if any is split.
    while (k < 3 && !(midpoints[k] >= 0 && midpoints[(k + 2) % 3] < 0)) {
        ++k;
    }
    const auto corner = [&](std::size_t i) { return triangle[(k + i) % 3]; };
    const auto middle = [&](std::size_t i) { return midpoints[(k + i) % 3]; };
    if (k == 3 && midpoints[0] < 0) {
        out.push_back(triangle);
    } else if (k == 3) {
        out.push_back({corner(0), middle(0), middle(2)});
        out.push_back({corner(1), middle(1), middle(0)});
        out.push_back({corner(2), middle(2), middle(1)});
        out.push_back({middle(0), middle(1), middle(2)});
    } else if (middle(1) < 0) {
        out.push_back({corner(0), middle(0), corner(2)});
        out.push_back({middle(0), corner(1), corner(2)});
    } else {
        out.push_back({middle(0), corner(1), middle(1)});
        out.push_back({corner(0), middle(0), middle(1)});
        out.push_back({corner(0), middle(1), corner(2)});
    }
}

}  // namespace

ChartSurface start_surface(TriangleMesh mesh, std::vector<std::uint8_t> lines) {
    ChartSurface surface;
    surface.mesh = std::move(mesh);
    surface.lines = std::move(lines);
    surface.source_vertex.resize(surface.mesh.positions.size());
    std::iota(surface.source_vertex.begin(), surface.source_vertex.end(), 0);
    surface.edges =
        build_half_edges(surface.mesh.triangles, static_cast<int>(surface.mesh.positions.size()));
    std::vector<char> chord(surface.edges.from.size(), 0);
    for (int h = 0; h < surface.edges.size(); ++h) {
        const unsigned shared =
            surface.lines[at(surface.edges.from_of(h))] & surface.lines[at(surface.edges.to_of(h))];
        chord[at(h)] = surface.edges.twin_of(h) >= 0 && shared != 0 ? 1 : 0;
    }
    return split_edges(std::move(surface), chord);
}

ChartSurface split_edges(ChartSurface surface, const std::vector<char>& marked) {
    if (std::find(marked.begin(), marked.end(), 1) == marked.end()) {
        return surface;
    }
    const std::vector<int> midpoint = add_midpoints(surface, marked);
    std::vector<std::array<int, 3>> pieces;
    pieces.reserve(surface.mesh.triangles.size());
    for (std::size_t t = 0; t < surface.mesh.triangles.size(); ++t) {
        append_pieces(pieces, surface.mesh.triangles[t],
                      {midpoint[3 * t], midpoint[3 * t + 1], midpoint[3 * t + 2]});
    }
    surface.mesh.triangles = std::move(pieces);
    surface.edges =
        build_half_edges(surface.mesh.triangles, static_cast<int>(surface.mesh.positions.size()));
    return surface;
}

std::vector<int> boundary_path(const HalfEdges& edges, int from, int to) {
    std::unordered_map<int, int> next;
    for (int h = 0; h < edges.size(); ++h) {
        if (edges.twin_of(h) < 0) {
            next[edges.from_of(h)] = edges.to_of(h);
        }
    }
    std::vector<int> path{from};
    for (int v = next.at(from); v != to; v = next.at(v)) {
        path.push_back(v);
    }
    if (from != to) {
        path.push_back(to);
    }
    return path;
}

}  // namespace leafcutter::geometry
