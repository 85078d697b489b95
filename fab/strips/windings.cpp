#include "fab/strips/windings.h"

#include <cstddef>
#include <cstdlib>
#include <utility>

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

std::vector<geometry::Thread> parted_windings(const geometry::QuadMesh& mesh,
                                              geometry::Thread thread) {
    std::vector<int> firsts;
    const std::size_t count = thread.quads.size();
    for (std::size_t i = 0; i < count && thread.closed; ++i) {
        if (is_closing_line(mesh, thread.quads[(i + count - 1) % count], thread.quads[i])) {
            firsts.push_back(static_cast<int>(i));
        }
    }
    if (firsts.size() < 2) {
        firsts.clear();
    }
    return geometry::parted(std::move(thread), firsts);
}

}  // namespace leafcutter::fab
