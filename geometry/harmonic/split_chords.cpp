#include "geometry/harmonic/split_chords.h"

#include <array>
#include <cstddef>
#include <numeric>
#include <utility>

#include "geometry/half_edges.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Adds a midpoint for each chord; returns it for both half-edges of the chord, -1 elsewhere.
std::vector<int> add_midpoints(SplitMesh& out, const HalfEdges& edges) {
    std::vector<int> midpoint(edges.from.size(), -1);
    for (int h = 0; h < edges.size(); ++h) {
        const int a = edges.from_of(h);
        const int b = edges.to_of(h);
        const bool chord = edges.twin_of(h) > h && (out.lines[at(a)] & out.lines[at(b)]) != 0;
        if (!chord) {
            continue;
        }
        midpoint[at(h)] = static_cast<int>(out.mesh.positions.size());
        midpoint[at(edges.twin_of(h))] = midpoint[at(h)];
        out.mesh.positions.emplace_back(0.5 *
                                        (out.mesh.positions[at(a)] + out.mesh.positions[at(b)]));
        out.source_vertex.push_back(-1);
        out.lines.push_back(0);
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

SplitMesh split_chords(TriangleMesh mesh, std::vector<std::uint8_t> lines) {
    SplitMesh out;
    out.mesh = std::move(mesh);
    out.lines = std::move(lines);
    out.source_vertex.resize(out.mesh.positions.size());
    std::iota(out.source_vertex.begin(), out.source_vertex.end(), 0);
    const HalfEdges edges =
        build_half_edges(out.mesh.triangles, static_cast<int>(out.mesh.positions.size()));
    const std::vector<int> midpoint = add_midpoints(out, edges);
    std::vector<std::array<int, 3>> pieces;
    pieces.reserve(out.mesh.triangles.size());
    for (std::size_t t = 0; t < out.mesh.triangles.size(); ++t) {
        append_pieces(pieces, out.mesh.triangles[t],
                      {midpoint[3 * t], midpoint[3 * t + 1], midpoint[3 * t + 2]});
    }
    out.mesh.triangles = std::move(pieces);
    return out;
}

}  // namespace leafcutter::geometry
