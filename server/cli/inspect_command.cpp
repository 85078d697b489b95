// `leafcutter inspect MODEL`: topology and defects of a mesh as JSON on stdout.

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "fab/foliation_options.h"
#include "fab/parts.h"
#include "geometry/error.h"
#include "geometry/io/read_mesh.h"
#include "geometry/repair.h"
#include "geometry/topology.h"
#include "server/cli/command.h"
#include "server/cli/input_file.h"

namespace leafcutter::server {

namespace {

using Json = nlohmann::ordered_json;

Json repairs_json(const geometry::RepairReport& report) {
    return {{"triangulated_polygons", report.triangulated_polygons},
            {"welded_vertices", report.welded_vertices},
            {"degenerate_faces_dropped", report.degenerate_faces_dropped},
            {"duplicate_faces_dropped", report.duplicate_faces_dropped},
            {"unused_vertices_dropped", report.unused_vertices_dropped},
            {"faces_reoriented", report.faces_reoriented},
            {"split_vertices", report.split_vertices}};
}

Json bounding_box_json(const geometry::Mesh& mesh) {
    Eigen::Vector3d low = mesh.point(geometry::Mesh::VertexHandle(0));
    Eigen::Vector3d high = low;
    for (const auto vertex : mesh.vertices()) {
        low = low.cwiseMin(mesh.point(vertex));
        high = high.cwiseMax(mesh.point(vertex));
    }
    return {{"min", {low.x(), low.y(), low.z()}}, {"max", {high.x(), high.y(), high.z()}}};
}

// Null where all vertices of the loop are copies that the repair made.
Json first_known(const std::vector<int>& loop, const std::vector<int>& input_of_vertex) {
    for (const int vertex : loop) {
        const int known = input_of_vertex[static_cast<std::size_t>(vertex)];
        if (known >= 0) {
            return known;
        }
    }
    return nullptr;
}

// By their numbers, with which parameters name them. Vertices are numbered as in the file, lengths
// are in its unit.
Json boundaries_json(const geometry::RepairedMesh& repaired, const geometry::Topology& topology) {
    const std::vector<int> input_of_vertex =
        fab::input_of_vertices(repaired.vertex_of_input, repaired.mesh.n_vertices());
    Json result = Json::array();
    for (std::size_t i = 0; i < topology.boundary_loops.size(); ++i) {
        const std::vector<int>& loop = topology.boundary_loops[i];
        double length = 0.0;
        for (std::size_t j = 0; j < loop.size(); ++j) {
            const auto point = [&](int vertex) {
                return repaired.mesh.point(geometry::Mesh::VertexHandle(vertex));
            };
            length += (point(loop[(j + 1) % loop.size()]) - point(loop[j])).norm();
        }
        result.push_back({{"number", i},
                          {"vertices", loop.size()},
                          {"length", length},
                          {"vertex", first_known(loop, input_of_vertex)}});
    }
    return result;
}

Json parts_json(const geometry::Mesh& mesh, const geometry::Topology& topology) {
    Json result = Json::array();
    for (const fab::Part& part : fab::parts_of(mesh, topology)) {
        result.push_back({{"vertices", part.vertices},
                          {"faces", part.faces},
                          {"genus", part.genus},
                          {"boundary_loops", part.boundary_loops},
                          {"euler", part.euler},
                          {"area", part.area}});
    }
    return result;
}

// Errors say which file they are about.
geometry::RepairedMesh load(const std::vector<std::byte>& bytes,
                            const std::string& path,
                            const geometry::ReadLimits& limits) {
    try {
        return geometry::repair(geometry::read_mesh(bytes, path, limits));
    } catch (const geometry::Error& error) {
        throw geometry::Error(error.kind(), error.code(), path + ": " + error.what());
    }
}

Json inspect(const std::string& path) {
    const geometry::ReadLimits limits;
    const std::vector<std::byte> bytes = read_input_file(path, limits.max_bytes);
    const geometry::RepairedMesh repaired = load(bytes, path, limits);
    const geometry::Topology topology = geometry::analyse_topology(repaired.mesh);
    return {{"format", "leafcutter-inspect/1"},
            {"file", path},
            {"vertices", topology.vertices},
            {"edges", topology.edges},
            {"faces", topology.faces},
            {"components", topology.components},
            {"genus", topology.genus},
            {"boundary_loops", topology.boundary_loops.size()},
            {"euler", topology.euler},
            {"boundaries", boundaries_json(repaired, topology)},
            {"parts", parts_json(repaired.mesh, topology)},
            {"orientable", true},
            {"repairs", repairs_json(repaired.report)},
            {"fatal", Json::array()},
            {"warnings", repaired.report.warnings},
            {"bounding_box", bounding_box_json(repaired.mesh)}};
}

}  // namespace

void add_inspect_command(CLI::App& app, const CommonOptions& /*common*/) {
    CLI::App* command = app.add_subcommand("inspect", "Topology and defects of a mesh, as JSON");
    const auto path = std::make_shared<std::string>();  // Lives as long as the callback.
    command->add_option("model", *path, "A mesh: .stl .obj .off .ply")->required();
    command->callback([path] {
        // File names needn't be UTF-8; JSON must be.
        const std::string text = inspect(*path).dump(2, ' ', false, Json::error_handler_t::replace);
        std::printf("%s\n", text.c_str());
    });
}

}  // namespace leafcutter::server
