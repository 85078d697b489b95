// A harmonic function between the boundary loops of a surface, and its conjugate: a closed one-form
// dg with |dg| = |df| at right angles, so that df - i dg is holomorphic (section 2.1).
//
// g itself is multivalued: it rises by the flux of f round every loop, and by something round every
// handle. Only its rise along half-edges is kept, antisymmetric and with sum zero round triangles.

#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "geometry/harmonic/chart_surface.h"

namespace leafcutter::geometry {

// Bits of ChartSurface::lines.
enum LoopBit : std::uint8_t {
    SourceLoop = 1,    // f = 0.
    SinkLoop = 2,      // f = 1.
    NaturalLoop = 4,   // No flux passes: a leaf of F*.
    BoundaryLoop = 8,  // Every loop: then no interior edge joins boundary vertices.
};

struct ConjugateForm {
    std::vector<double> f;     // Per vertex.
    std::vector<double> rise;  // Of g along each half-edge; 0 along natural loops.
    double flux = 0.0;         // Of f from sources to sinks: twice its energy, that is f's bound of
                               // the modulus from above,
    double conjugate = 0.0;    // and twice the energy of g, not less: they agree in the limit.
};

// One of the loops is a source, one a sink. g rises along sources, the surface to the left, and
// falls along sinks: (g, f) is right-handed.
ConjugateForm solve_conjugate_form(const ChartSurface& surface);

// The half-edges of each boundary loop in order, surface to the left.
std::vector<std::vector<int>> boundary_walks(const HalfEdges& edges);

// One half-edge out of each vertex: the boundary's where there is one, so that turning to the left
// from it passes the whole fan; -1 if there is none.
std::vector<int> first_outgoing(const HalfEdges& edges, int vertex_count);

// The next half-edge out of the same vertex to the left of `half_edge`, or -1 at the boundary.
inline int turn_left(const HalfEdges& edges, int half_edge) {
    return edges.twin_of(HalfEdges::previous(half_edge));
}

}  // namespace leafcutter::geometry
