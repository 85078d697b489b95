// Which quads meet across which sides. Sides of a quad: 0 a–b, 1 b–c, 2 c–d, 3 d–a.

#pragma once

#include <array>
#include <span>
#include <vector>

namespace leafcutter::geometry {

struct QuadSide {
    int quad = -1;  // -1: none, the side lies on a boundary.
    int side = 0;
};

struct QuadNeighbours {
    std::vector<std::array<QuadSide, 4>> across;  // Per quad and side what lies behind it.
    int edges = 0;
    int boundary_edges = 0;
    int faults = 0;  // Edges of more than two quads, or of two that don't agree on a direction.
};

// By shared vertex pairs. A faulty edge is treated as boundary. O(n log n).
QuadNeighbours find_neighbours(std::span<const std::array<int, 4>> quads);

}  // namespace leafcutter::geometry
