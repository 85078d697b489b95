// Round holes in a surface (figure 10): at the tips of limbs, or where the user wants them.

#pragma once

#include <span>
#include <vector>

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

// A surface with holes opened. Splitting triangles moves no vertex and changes no area.
struct OpenedMesh {
    TriangleMesh mesh;
    std::vector<int> source_vertex;       // Vertex of the surface given, or -1.
    std::vector<Puncture> punctures;      // As opened: vertices of the surface given.
    std::vector<std::vector<int>> loops;  // Boundary of each hole, surface to the left.
    double removed_area = 0.0;            // In units of the mesh, squared.
};

enum class PunctureFit {
    AsGiven,  // Refuses a radius that doesn't fit.
    Shrink    // Makes it smaller; leaves a puncture out that fits no sensible hole.
};

// Cuts out the geodesic disk of its radius round the vertex of each puncture. Triangles near a hole
// are split flat, so that its boundary has at least 32 vertices. The holes keep clear of each other
// and of the boundary, and what is cut out is a disk.
//
// Throws Error(BadOption, "bad-puncture"), which names the puncture and a radius that would do.
OpenedMesh open_punctures(const TriangleMesh& mesh,
                          std::span<const Puncture> punctures,
                          const Context& context,
                          PunctureFit fit = PunctureFit::AsGiven);

}  // namespace leafcutter::geometry
