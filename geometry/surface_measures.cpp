#include "geometry/surface_measures.h"

#include <cstddef>

#include <Eigen/Geometry>

namespace leafcutter::geometry {

double surface_area(const TriangleMesh& mesh) {
    double area = 0.0;
    for (const auto& t : mesh.triangles) {
        const Eigen::Vector3d& a = mesh.positions[static_cast<std::size_t>(t[0])];
        const Eigen::Vector3d ab = mesh.positions[static_cast<std::size_t>(t[1])] - a;
        const Eigen::Vector3d ac = mesh.positions[static_cast<std::size_t>(t[2])] - a;
        area += 0.5 * ab.cross(ac).norm();
    }
    return area;
}

double diagonal(const TriangleMesh& mesh) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : mesh.positions) {
        box.extend(p);
    }
    return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

}  // namespace leafcutter::geometry
