// Cuts a surface along closed lines of edges.

#pragma once

#include <array>
#include <span>
#include <vector>

namespace leafcutter::geometry {

// What a boundary loop of a piece was before: a boundary loop, or one side of a cut.
struct LoopOrigin {
    int boundary = -1;
    int cut = -1;
    bool left = false;  // The piece lies on the left of the cut.
};

// One connected part, with its own numbering of vertices.
struct CutPiece {
    std::vector<std::array<int, 3>> triangles;
    std::vector<int> source_vertex;
    std::vector<std::vector<int>> loops;  // Surface to the left.
    std::vector<LoopOrigin> origins;      // Per loop.
    int euler = 0;
};

// The connected surface of `triangles`, without unused vertices, its boundary loops, and simple
// closed vertex cycles of at least three edges, disjoint from each other and from the boundary.
// Pieces and their vertices come in the order of triangles.
std::vector<CutPiece> cut_along(std::span<const std::array<int, 3>> triangles,
                                int vertex_count,
                                std::span<const std::vector<int>> boundary_loops,
                                std::span<const std::vector<int>> cuts);

}  // namespace leafcutter::geometry
