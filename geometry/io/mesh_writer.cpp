#include "geometry/io/mesh_writer.h"

#include <cassert>
#include <iterator>

#include <fmt/format.h>

namespace leafcutter::geometry {

namespace {

// fmt's "{}" of a double is the shortest text that reads back as the same double, in any locale.
void append_position(fmt::memory_buffer& out, const Eigen::Vector3d& p) {
    fmt::format_to(std::back_inserter(out), "{} {} {}", p.x(), p.y(), p.z());
}

}  // namespace

std::string write_obj(const TriangleMesh& mesh) {
    fmt::memory_buffer out;
    for (const Eigen::Vector3d& position : mesh.positions) {
        fmt::format_to(std::back_inserter(out), "v ");
        append_position(out, position);
        out.push_back('\n');
    }
    for (const auto& [a, b, c] : mesh.triangles) {
        fmt::format_to(std::back_inserter(out), "f {} {} {}\n", a + 1, b + 1, c + 1);
    }
    return fmt::to_string(out);
}

std::string write_off(const TriangleMesh& mesh) {
    fmt::memory_buffer out;
    fmt::format_to(std::back_inserter(out), "OFF\n{} {} 0\n", mesh.positions.size(),
                   mesh.triangles.size());
    for (const Eigen::Vector3d& position : mesh.positions) {
        append_position(out, position);
        out.push_back('\n');
    }
    for (const auto& [a, b, c] : mesh.triangles) {
        fmt::format_to(std::back_inserter(out), "3 {} {} {}\n", a, b, c);
    }
    return fmt::to_string(out);
}

std::string write_ply(const TriangleMesh& mesh, std::span<const VertexProperty> properties) {
    fmt::memory_buffer out;
    const auto append = std::back_inserter(out);
    fmt::format_to(append, "ply\nformat ascii 1.0\nelement vertex {}\n", mesh.positions.size());
    for (const char axis : {'x', 'y', 'z'}) {
        fmt::format_to(append, "property float64 {}\n", axis);
    }
    for (const VertexProperty& property : properties) {
        assert(property.values.size() == mesh.positions.size());
        fmt::format_to(append, "property float64 {}\n", property.name);
    }
    fmt::format_to(append,
                   "element face {}\nproperty list uint8 int32 vertex_indices\nend_header\n",
                   mesh.triangles.size());
    for (std::size_t vertex = 0; vertex < mesh.positions.size(); ++vertex) {
        append_position(out, mesh.positions[vertex]);
        for (const VertexProperty& property : properties) {
            fmt::format_to(append, " {}", property.values[vertex]);
        }
        out.push_back('\n');
    }
    for (const auto& [a, b, c] : mesh.triangles) {
        fmt::format_to(append, "3 {} {} {}\n", a, b, c);
    }
    return fmt::to_string(out);
}

}  // namespace leafcutter::geometry
