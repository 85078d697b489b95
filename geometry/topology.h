// Components, boundary loops, Euler characteristic and genus of a surface.

#pragma once

#include <vector>

#include "geometry/mesh.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

struct Topology {
    int vertices = 0;
    int edges = 0;
    int faces = 0;
    int components = 0;
    int euler = 0;                                 // Of all components together.
    int genus = 0;                                 // Sum over components.
    std::vector<std::vector<int>> boundary_loops;  // Vertices of each loop, surface to the left.
    std::vector<int> component_of_face;
};

Topology analyse_topology(const Mesh& mesh);

// Positions and triangles of `mesh`, indices unchanged. `mesh` has no deleted elements.
TriangleMesh to_triangle_mesh(const Mesh& mesh);

}  // namespace leafcutter::geometry
