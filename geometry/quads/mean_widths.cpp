#include "geometry/quads/mean_widths.h"

#include <array>
#include <cstddef>
#include <numeric>

namespace leafcutter::geometry {

MeanWidths mean_widths(const QuadMesh& mesh) {
    const double area = std::accumulate(mesh.surface_area.begin(), mesh.surface_area.end(), 0.0);
    double weft = 0.0;
    double warp = 0.0;
    for (const std::array<int, 4>& quad : mesh.quads) {
        const auto length = [&](std::size_t from, std::size_t to) {
            return (mesh.vertices[static_cast<std::size_t>(quad[to])] -
                    mesh.vertices[static_cast<std::size_t>(quad[from])])
                .norm();
        };
        weft += 0.5 * (length(0, 1) + length(3, 2));
        warp += 0.5 * (length(0, 3) + length(1, 2));
    }
    return {.weft_mm = area / weft, .warp_mm = area / warp};
}

}  // namespace leafcutter::geometry
