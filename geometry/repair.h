// From polygon soup to an oriented manifold surface: triangulate, weld equal positions, drop
// degenerate and duplicate faces and unused vertices, orient consistently.
//
// All tolerances are relative to the bounding box. What was done is counted; what can't be mended
// is refused with its place.

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

struct RepairReport {
    std::size_t triangulated_polygons = 0;
    std::size_t welded_vertices = 0;
    std::size_t degenerate_faces_dropped = 0;
    std::size_t duplicate_faces_dropped = 0;
    std::size_t unused_vertices_dropped = 0;
    std::size_t faces_reoriented = 0;
    std::size_t split_vertices = 0;  // Copies made where fans of faces touched in one vertex only.
    std::vector<std::string> warnings;  // Sentences for people.
};

struct RepairedMesh {
    Mesh mesh;
    std::vector<int> vertex_of_input;  // Per input vertex: vertex of `mesh`, or -1 if dropped.
    RepairReport report;
};

// Returns the surface that `soup` describes; components may be several, boundaries any number.
//
// Throws Error(BadMesh) with code "no-faces", "zero-area", "non-manifold-edges",
// "non-manifold-vertices", "not-orientable" or "degenerate" and the count and first place of the
// defect.
RepairedMesh repair(const PolygonSoup& soup);

}  // namespace leafcutter::geometry
