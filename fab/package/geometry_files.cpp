// The package's geometry: quads.obj, surface.ply, leaves.json.

#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/package/package_files.h"
#include "geometry/io/mesh_writer.h"

namespace leafcutter::fab {

namespace {

using nlohmann::json;

json point_json(const Eigen::Vector3d& point) {
    return {point.x(), point.y(), point.z()};
}

json points_json(const std::vector<Eigen::Vector3d>& line) {
    json points = json::array();
    for (const Eigen::Vector3d& point : line) {
        points.push_back(point_json(point));
    }
    return points;
}

// Lifts differ by a period from triangle to triangle; files get the one in [0, period).
double into_period(double value, double period) {
    const double rest = std::fmod(value, period);
    return rest < 0.0 ? rest + period : rest;
}

}  // namespace

std::string quads_obj(const JobResult& job) {
    std::string out = "# Leafcutter quad mesh, mm; a-b and d-c along leaves of F\n";
    const auto append = std::back_inserter(out);
    for (const Eigen::Vector3d& p : job.quads.vertices) {
        fmt::format_to(append, "v {} {} {}\n", p.x(), p.y(), p.z());
    }
    int cylinder = -1;
    for (std::size_t i = 0; i < job.quads.quads.size(); ++i) {
        if (job.quads.addresses[i].cylinder != cylinder) {
            cylinder = job.quads.addresses[i].cylinder;
            fmt::format_to(append, "g cylinder_{}\n", cylinder);
        }
        const auto& [a, b, c, d] = job.quads.quads[i];
        fmt::format_to(append, "f {} {} {} {}\n", a + 1, b + 1, c + 1, d + 1);
    }
    return out;
}

std::string surface_ply(const JobResult& job) {
    geometry::TriangleMesh whole;
    std::vector<geometry::VertexProperty> properties = {{"cylinder", {}}, {"f", {}}, {"g", {}}};
    for (std::size_t k = 0; k < job.foliation.cylinders.size(); ++k) {
        const geometry::Cylinder& cylinder = job.foliation.cylinders[k];
        const auto base = whole.positions.size();
        const auto& positions = cylinder.mesh.positions;
        whole.positions.insert(whole.positions.end(), positions.begin(), positions.end());
        for (geometry::VertexProperty& property : properties) {
            property.values.resize(whole.positions.size(), 0.0);
        }
        for (std::size_t t = 0; t < cylinder.mesh.triangles.size(); ++t) {
            std::array<int, 3> triangle = cylinder.mesh.triangles[t];
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const auto at = base + static_cast<std::size_t>(triangle[corner]);
                const Eigen::Vector2d& gf = cylinder.corner_gf[t][corner];
                const bool ring = cylinder.shape != geometry::ChartShape::Rectangle;
                const bool torus = cylinder.shape == geometry::ChartShape::Torus;
                properties[0].values[at] = static_cast<double>(k);
                properties[1].values[at] = torus ? into_period(gf.y(), cylinder.height) : gf.y();
                properties[2].values[at] = ring ? into_period(gf.x(), cylinder.width) : gf.x();
                triangle[corner] = static_cast<int>(at);
            }
            whole.triangles.push_back(triangle);
        }
    }
    return geometry::write_ply(whole, properties);
}

std::string leaves_json(const JobResult& job) {
    json leaves = json::array();
    for (const geometry::Leaf& leaf : job.leaves) {
        leaves.push_back({{"family", leaf.of_conjugate ? "warp" : "weft"},
                          {"cylinder", leaf.cylinder},
                          {"level", leaf.level},
                          {"closed", leaf.closed},
                          {"points", points_json(leaf.points)}});
    }
    json critical_graph = json::array();
    for (const std::vector<Eigen::Vector3d>& line : job.foliation.critical_graph) {
        critical_graph.push_back({{"points", points_json(line)}});
    }
    json singularities = json::array();
    for (const geometry::Singularity& singularity : job.foliation.singularities) {
        singularities.push_back(
            {{"position", point_json(singularity.position)}, {"prongs", singularity.prongs}});
    }
    const json file = {{"format", "leafcutter-leaves/1"},
                       {"leaves", std::move(leaves)},
                       {"critical_graph", std::move(critical_graph)},
                       {"singularities", std::move(singularities)}};
    return file.dump() + "\n";
}

}  // namespace leafcutter::fab
