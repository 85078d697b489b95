// The double cover of a closed surface of genus 0, branched at four of its vertices. It is a torus,
// and the surface is its quotient by the exchange of the two sheets.
//
// A quadratic differential with simple poles at the four vertices is the square of a one-form
// there. Every harmonic one-form of the cover is odd: the exchange of sheets changes its sign. So
// the flat torus, halved by a half turn, is the pillowcase.

#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/half_edges.h"
#include "geometry/harmonic/periodic_forms.h"
#include "geometry/intrinsic_delaunay.h"
#include "geometry/laplacian.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

struct BranchedCover {
    // Triangle t of the surface is t and t + surface triangles, one for each sheet.
    HalfEdges edges;
    std::vector<int> vertex_below;          // Per vertex of the cover: of the surface.
    std::vector<std::array<int, 2>> above;  // Per vertex of the surface; equal where branched.

    int vertex_count() const { return static_cast<int>(vertex_below.size()); }
    // The same half-edge in the other sheet.
    int other_sheet(int half_edge) const {
        const int half = edges.size() / 2;
        return half_edge < half ? half_edge + half : half_edge - half;
    }
};

// `edges` is a triangulation of a sphere; it need not be simplicial.
BranchedCover branched_cover(const HalfEdges& edges,
                             int vertex_count,
                             const std::array<int, 4>& points);

TriangleMesh cover_mesh(const TriangleMesh& surface, const BranchedCover& cover);

// A basis of the integer cohomology of the cover, and by how much its integrals fail to be odd: a
// function with these jumps can be chosen such that it is fold[v] - its value at the other vertex
// above v. It is then fold / 2 at branch points: 0 at the first.
struct OddCochains {
    std::array<Cochain, 2> jump;
    std::array<std::vector<int>, 2> fold;  // Per vertex of the surface.
};

// Throws Error(SelfCheck, "cover-not-odd") if the cover is not a torus or not branched at `first`.
OddCochains odd_cochains(const BranchedCover& cover, int first);

// Harmonic forms in the two classes, exactly odd. One system of the size of the surface is solved
// for both. `edges` are those of a triangulation of the cover with the cover's vertices, `jump` the
// basis cochains on them, one entry for each edge.
HarmonicForms solve_odd_forms(const BranchedCover& cover,
                              const OddCochains& cochains,
                              std::span<const WeightedEdge> edges,
                              std::span<const Jump> jump);

}  // namespace leafcutter::geometry
