// The surface a chart is computed on: the given one, with some triangles split flat. Splits add
// vertices, never move one.

#pragma once

#include <cstdint>
#include <vector>

#include "geometry/half_edges.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

struct ChartSurface {
    TriangleMesh mesh;               // The given vertices first, then midpoints.
    HalfEdges edges;                 // Of `mesh`.
    std::vector<int> source_vertex;  // Given vertex, or -1.

    // Per vertex a bit for every straight line of the chart's boundary that it is mapped to.
    std::vector<std::uint8_t> lines;
};

// Splits every interior edge whose two ends lie on one line, or its triangles would be pressed
// flat.
ChartSurface start_surface(TriangleMesh mesh, std::vector<std::uint8_t> lines);

// Splits the marked edges in their middle. `marked` has an entry for each half-edge; one of an
// edge's two is enough.
ChartSurface split_edges(ChartSurface surface, const std::vector<char>& marked);

// The vertices of the boundary from `from` to `to`, both included, surface to the left; the whole
// loop, `from` once, if they are equal.
std::vector<int> boundary_path(const HalfEdges& edges, int from, int to);

}  // namespace leafcutter::geometry
