#include "fab/strips/windings.h"

#include <cstddef>
#include <cstdlib>

namespace leafcutter::fab {

namespace {

bool is_closing_line(const geometry::QuadMesh& mesh, int quad, int next) {
    const geometry::QuadAddress& one = mesh.addresses[static_cast<std::size_t>(quad)];
    const geometry::QuadAddress& other = mesh.addresses[static_cast<std::size_t>(next)];
    if (one.cylinder != other.cylinder) {
        return false;
    }
    const geometry::CylinderGrid& grid = mesh.grids[static_cast<std::size_t>(one.cylinder)];
    if (grid.shape == geometry::ChartShape::Pillowcase) {
        return one.row == grid.rows - 1 && other.row == one.row;
    }
    return grid.shape == geometry::ChartShape::Torus && grid.rows > 2 &&
           std::abs(one.row - other.row) == grid.rows - 1;
}

}  // namespace

std::vector<int> winding_joints(const geometry::QuadMesh& mesh, const Strip& strip) {
    std::vector<int> joints;
    const std::size_t count = strip.quads.size();
    for (std::size_t i = 0; i < count && strip.closed && strip.family == Family::Warp; ++i) {
        if (is_closing_line(mesh, strip.quads[(i + count - 1) % count], strip.quads[i])) {
            joints.push_back(static_cast<int>(i));
        }
    }
    if (joints.size() < 2) {
        joints.clear();
    }
    return joints;
}

}  // namespace leafcutter::fab
