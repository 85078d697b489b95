// Binary STL: 80 bytes of header, the number of triangles, then per triangle a normal, three
// points (32-bit floats) and two unused bytes.

#include <Eigen/Geometry>

#include "fab/export/bytes.h"
#include "fab/export/solids.h"

namespace leafcutter::fab {

namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kTriangleBytes = 50;

void append(std::string& out, const Eigen::Vector3d& point) {
    append_bytes(out, static_cast<float>(point.x()));
    append_bytes(out, static_cast<float>(point.y()));
    append_bytes(out, static_cast<float>(point.z()));
}

}  // namespace

std::string write_stl(std::span<const Solid> solids) {
    std::size_t count = 0;
    for (const Solid& solid : solids) {
        count += solid.triangles.size();
    }
    // A header that began with "solid" would pass for the text form.
    std::string out = "Leafcutter woven model, mm";
    out.reserve(kHeaderBytes + 4 + kTriangleBytes * count);
    out.resize(kHeaderBytes, ' ');
    append_bytes(out, static_cast<std::uint32_t>(count));
    for (const Solid& solid : solids) {
        for (const auto& [i, j, k] : solid.triangles) {
            const Eigen::Vector3d& a = solid.vertices[static_cast<std::size_t>(i)];
            const Eigen::Vector3d& b = solid.vertices[static_cast<std::size_t>(j)];
            const Eigen::Vector3d& c = solid.vertices[static_cast<std::size_t>(k)];
            append(out, (b - a).cross(c - a).stableNormalized());
            append(out, a);
            append(out, b);
            append(out, c);
            append_bytes(out, std::uint16_t{0});
        }
    }
    return out;
}

}  // namespace leafcutter::fab
