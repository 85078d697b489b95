// What is measured vertex by vertex: the paper's angle deviation (section 5.1), the least it can be
// on the leaves there are, and the angle at which leaves cross.

#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

// What the quads around a vertex form.
enum class VertexPlace {
    None,      // No quad is here.
    Regular,   // Inside, four quads around.
    Singular,  // Inside, another number of quads around.
    Boundary,  // At the edge.
    Corner     // At the edge, a single quad.
};

struct VertexQuality {
    VertexPlace place = VertexPlace::None;

    double angle_deviation_deg = 0.0;  // (1/k) Σ |corner − 90| over its k corners.

    // Inside: the least that angle_deviation_deg can be, with the leaves turning as they do. Of the
    // angles on the two sides of a leaf one is too large by its turning θ and one too small, two
    // corners each: the mean deviation is at least θ/2, θ the larger of the two leaves'. Where k
    // corners share a full turn it is at least |360/k − 90|: at a point of three prongs (valence 6)
    // the critical leaves turn by 60 degrees, hence 30.
    std::optional<double> bound_deg = {};

    // Regular: |angle between the chords through the neighbours along each leaf − 90|.
    std::optional<double> crossing_deviation_deg = {};
};

// One for each vertex of the mesh, of `quads` alone: with those of one cylinder its rim is an edge,
// with all of them leaves go on across the junctions, wherever vertices are shared.
std::vector<VertexQuality> measure_vertices(const QuadMesh& mesh,
                                            std::span<const std::size_t> quads);

}  // namespace leafcutter::geometry
