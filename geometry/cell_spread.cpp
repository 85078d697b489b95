#include "geometry/cell_spread.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/plane.h"

namespace leafcutter::geometry {
namespace {

constexpr double kTopShare = 0.01;  // Of the surface, whose cells count as the largest.

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

}  // namespace

CellSpread cell_spread(std::span<const FlatArea> parts) {
    double surface = 0.0;
    double flat = 0.0;
    for (const FlatArea& part : parts) {
        surface += part.surface;
        flat += part.flat;
    }
    CellSpread spread;
    if (!(surface > 0.0) || !(flat > 0.0)) {
        return spread;
    }
    const double mean = surface / flat;  // Surface area of a unit of the flat metric.
    // A part pressed flat beyond rounding would make everything infinite.
    const double least = 1e-12 * flat / static_cast<double>(parts.size());
    std::vector<FlatArea> sorted;
    double square = 0.0;
    for (const FlatArea& part : parts) {
        const double clamped = std::max(part.flat, least);
        sorted.push_back({part.surface, clamped});
        square += part.surface * part.surface / clamped;
    }
    spread.variation = std::sqrt(std::max(square / flat / (mean * mean) - 1.0, 0.0));
    std::sort(sorted.begin(), sorted.end(), [](const FlatArea& a, const FlatArea& b) {
        return a.surface * b.flat > b.surface * a.flat;
    });
    FlatArea top;
    for (const FlatArea& part : sorted) {
        top.surface += part.surface;
        top.flat += part.flat;
        if (top.surface >= kTopShare * surface) {
            break;
        }
    }
    spread.largest = std::sqrt(top.surface / top.flat / mean);
    return spread;
}

CellSpread cell_spread(std::span<const Cylinder> cylinders) {
    std::vector<FlatArea> parts;
    for (const Cylinder& cylinder : cylinders) {
        for (std::size_t t = 0; t < cylinder.mesh.triangles.size(); ++t) {
            const auto& triangle = cylinder.mesh.triangles[t];
            const Eigen::Vector3d& a = cylinder.mesh.positions[at(triangle[0])];
            const Eigen::Vector3d ab = cylinder.mesh.positions[at(triangle[1])] - a;
            const Eigen::Vector3d ac = cylinder.mesh.positions[at(triangle[2])] - a;
            const auto& gf = cylinder.corner_gf[t];
            const Eigen::Vector2d p = gf[1] - gf[0];
            const Eigen::Vector2d q = gf[2] - gf[0];
            parts.push_back({0.5 * ab.cross(ac).norm(), 0.5 * std::abs(turn_of(p, q))});
        }
    }
    return cell_spread(parts);
}

}  // namespace leafcutter::geometry
