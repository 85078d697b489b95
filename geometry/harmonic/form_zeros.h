// The zeros of a closed one-form that is linear on triangles, by how often it changes sign round
// each vertex: twice at an ordinary vertex, 2 + 2 m times at a zero of order m, never at an
// extremum of g. Orders add up to minus the Euler characteristic (index theorem of Gortler,
// Gotsman, Thurston, "Discrete one-forms on meshes", 2006), a zero on a natural loop counting half.

#pragma once

#include <vector>

#include "geometry/harmonic/chart_surface.h"
#include "geometry/harmonic/conjugate_form.h"

namespace leafcutter::geometry {

// Whether g rises along a half-edge. Ties are broken as if g rose by a trifle with the number of a
// vertex.
bool rises(const HalfEdges& edges, const std::vector<double>& rise, int half_edge);

struct FormZero {
    int vertex = 0;
    int lines = 0;  // Sign changes: leaves of F* that end here. Even inside, any on natural loops.
};

struct FormZeros {
    std::vector<FormZero> zeros;
    // Where no harmonic form looks like that: extrema inside, and vertices of sources and sinks
    // where g doesn't pass in its direction or has a zero.
    std::vector<int> irregular;
};

FormZeros find_zeros(const ChartSurface& surface, const std::vector<double>& rise);

// The values of a piecewise linear solution may have irregular vertices. Adds the differences of a
// function to `rise`: first at sources and sinks, so that g is monotone there; then near irregular
// vertices, and `everywhere` if that is allowed, so that g is a mean of its neighbours' with
// positive weights. Returns the zeros then.
enum class FormRepair { Near, Everywhere };
FormZeros make_regular(const ChartSurface& surface, std::vector<double>& rise, FormRepair repair);

}  // namespace leafcutter::geometry
