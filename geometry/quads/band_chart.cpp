#include "geometry/quads/band_chart.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

}  // namespace

Cylinder chart_of_band(const Foliation& foliation, const FormBand& band, double low, double high) {
    Cylinder out;
    out.shape = ChartShape::Rectangle;
    out.height = high - low;
    for (const int c : band.cylinders) {
        const Cylinder& from = foliation.cylinders[at(c)];
        out.width += from.width;
        for (std::size_t t = 0; t < from.corner_gf.size(); ++t) {
            std::array<Eigen::Vector2d, 3> gf = from.corner_gf[t];
            double least = high;
            double most = low;
            for (Eigen::Vector2d& corner : gf) {
                least = std::min(least, corner.y());
                most = std::max(most, corner.y());
                corner.y() -= low;
            }
            if (least >= high || most <= low) {
                continue;
            }
            const int first = static_cast<int>(out.mesh.positions.size());
            for (const int v : from.mesh.triangles[t]) {
                out.mesh.positions.push_back(from.mesh.positions[at(v)]);
            }
            out.mesh.triangles.push_back({first, first + 1, first + 2});
            out.corner_gf.push_back(gf);
        }
    }
    return out;
}

}  // namespace leafcutter::geometry
