// The half-sag offset: vertices half a sagitta off the surface, so that the chord errors of the
// quads lie evenly on both sides of it.

#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace leafcutter::geometry {

struct SagCell {
    std::array<int, 4> corners;           // Indices of vertices.
    Eigen::Vector3d surface_centre;       // The surface at the middle of the cell.
    Eigen::Vector3d surface_vector_area;  // Of the region it stands for.
};

// Moves each vertex by half the mean sag of its cells, along their normals. Where a cell is no
// chord of the surface (it spans a limb), or would be turned over, its corners stay.
void offset_by_half_sag(std::vector<Eigen::Vector3d>& vertices, std::span<const SagCell> cells);

// Whether the quad faces away from the surface region it stands for. Regions without a clear
// direction of their own (those that close up around a limb) say nothing.
bool is_inverted(const std::vector<Eigen::Vector3d>& vertices,
                 const std::array<int, 4>& corners,
                 const Eigen::Vector3d& surface_vector_area);

}  // namespace leafcutter::geometry
