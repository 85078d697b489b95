// Plain mesh values that cross module borders. Positions are in the unit of the input until the
// pipeline has scaled them, then in millimetres.

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace leafcutter::geometry {

// Faces as a reader found them: any corner count, nothing checked but index range and finiteness.
struct PolygonSoup {
    std::vector<Eigen::Vector3d> positions;
    std::vector<std::uint32_t> corners;       // Vertex indices of all faces, one after the other.
    std::vector<std::uint32_t> face_offsets;  // faces + 1 entries into `corners`; first is 0.

    std::size_t face_count() const { return face_offsets.empty() ? 0 : face_offsets.size() - 1; }
};

// An indexed triangle mesh, counter-clockwise seen from outside.
struct TriangleMesh {
    std::vector<Eigen::Vector3d> positions;
    std::vector<std::array<int, 3>> triangles;
};

}  // namespace leafcutter::geometry
