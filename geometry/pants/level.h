// Levels of detail of a surface for the graph-valued map: collapse to coarser meshes, maps carried
// from coarse to fine, intrinsic flips for good weights and their undoing.
//
// A map travels from a coarse level to a finer one as the composition with the simplicial collapse:
// its homotopy class is kept exactly.

#pragma once

#include <span>
#include <vector>

#include "geometry/context.h"
#include "geometry/half_edges.h"
#include "geometry/pants/tree_word.h"
#include "geometry/pants/vertex_rings.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

// A simplicial surface: no edge joins two vertices twice, none a vertex to itself. Closed lines of
// edges on it (boundary loops, loops to cut along) survive every collapse and flip.
struct LinedSurface {
    TriangleMesh mesh;
    std::vector<int> line_of_vertex;  // Number of the closed line through a vertex, or -1.
};

// --- collapse ---------------------------------------------------------------------------------

struct Coarser {
    LinedSurface surface;
    std::vector<int> representative;  // Per vertex of the finer surface: its vertex here.
};

struct CoarsenOptions {
    std::size_t target_vertices = 6000;
    int least_line_vertices = 24;  // A closed line keeps at least so many (or all it had).
};

// Half-edge collapses that keep the topology (link condition), the lines and decent triangles,
// until the target is met or nothing more can go. Deterministic. Every edge of `fine` has two equal
// representatives or two that an edge of the result joins.
Coarser coarsen(const LinedSurface& fine, const CoarsenOptions& options, const Context& context);

// --- intrinsic flips ----------------------------------------------------------------------------

// Same vertices, edges flipped towards Delaunay, still simplicial; edges of lines are not flipped.
struct FlippedSurface {
    VertexRings rings;  // Edge ids agree with those of the rings it was made from: a flip keeps its
                        // edge's id.
    HalfEdges half_edges;
    std::vector<double> weights;  // Per edge: (cot + cot) / 2, at least a small positive number.
    // Per triangle (three consecutive half-edges) of half_edges.
    std::vector<double> area;
    std::vector<int> flips;  // Edge ids in the order they were flipped.
    int forced_weights = 0;  // Inner edges with a negative weight, whose flip was refused.
};

FlippedSurface flip_to_delaunay(const LinedSurface& surface, const VertexRings& rings);

// Carries the words of a converged map back from the flipped surface to the surface it was made
// from: `words` are per edge id of `flipped` on entry, of `rings` afterwards, each from that ring's
// MeshEdge::from to its to. Places stay. Throws Error(SelfCheck, "broken-tree") where words round a
// triangle don't fit together.
void undo_flips(GraphMap& map,
                const FlippedSurface& flipped,
                const LinedSurface& surface,
                const VertexRings& rings);

// --- prolongation -------------------------------------------------------------------------------

// The map of the coarse surface, seen from the fine one: vertices at their representative's place,
// words of the coarse edges. `fine_rings` may be those of a flipped surface as long as every edge's
// representatives are equal or joined by a coarse edge.
// Throws Error(SelfCheck, "broken-tree") if they are not.
GraphMap prolong(const GraphMap& coarse,
                 const VertexRings& coarse_rings,
                 std::span<const int> representative,
                 const VertexRings& fine_rings);

}  // namespace leafcutter::geometry
