#include "geometry/quads/mean_widths.h"

#include <array>
#include <cstddef>

#include <Eigen/Geometry>

namespace leafcutter::geometry {

MeanWidths mean_widths(const QuadMesh& mesh) {
    double area = 0.0;
    double weft = 0.0;
    double warp = 0.0;
    for (const std::array<int, 4>& quad : mesh.quads) {
        const auto corner = [&](std::size_t i) -> const Eigen::Vector3d& {
            return mesh.vertices[static_cast<std::size_t>(quad[i])];
        };
        // Split along a–c, as everywhere.
        const Eigen::Vector3d diagonal = corner(2) - corner(0);
        area += 0.5 * ((corner(1) - corner(0)).cross(diagonal).norm() +
                       diagonal.cross(corner(3) - corner(0)).norm());
        weft += 0.5 * ((corner(1) - corner(0)).norm() + (corner(2) - corner(3)).norm());
        warp += 0.5 * ((corner(3) - corner(0)).norm() + (corner(2) - corner(1)).norm());
    }
    return {.weft_mm = area / weft, .warp_mm = area / warp};
}

}  // namespace leafcutter::geometry
