#include <vector>

#include <gtest/gtest.h>

#include "fab/parts.h"
#include "geometry/repair.h"
#include "geometry/samples.h"

namespace leafcutter::fab {
namespace {

// Surfaces side by side, none touching another.
geometry::Mesh beside(const std::vector<geometry::TriangleMesh>& surfaces) {
    geometry::PolygonSoup soup;
    soup.face_offsets.push_back(0);
    double shift = 0.0;
    for (const geometry::TriangleMesh& surface : surfaces) {
        const auto base = static_cast<std::uint32_t>(soup.positions.size());
        for (const Eigen::Vector3d& point : surface.positions) {
            soup.positions.emplace_back(point.x() + shift, point.y(), point.z());
        }
        for (const auto& triangle : surface.triangles) {
            for (const int vertex : triangle) {
                soup.corners.push_back(base + static_cast<std::uint32_t>(vertex));
            }
            soup.face_offsets.push_back(static_cast<std::uint32_t>(soup.corners.size()));
        }
        shift += 100.0;
    }
    return geometry::repair(soup).mesh;
}

TEST(Parts, HaveEachTheirOwnTopology) {
    const auto torus = geometry::make_sample("torus", 800);
    const auto cylinder = geometry::make_sample("cylinder", 800);
    const auto eight = geometry::make_sample("eight", 2000);
    const geometry::Mesh mesh = beside({torus, cylinder, eight});
    const geometry::Topology topology = geometry::analyse_topology(mesh);
    const std::vector<Part> parts = parts_of(mesh, topology);
    ASSERT_EQ(parts.size(), 3U);
    EXPECT_EQ(parts[0].genus, 1);
    EXPECT_EQ(parts[1].genus, 0);
    EXPECT_EQ(parts[1].boundary_loops, (std::vector<int>{0, 1}));
    EXPECT_EQ(parts[2].genus, 2);
    EXPECT_EQ(parts[2].euler, -2);
    EXPECT_EQ(parts[0].faces + parts[1].faces + parts[2].faces, topology.faces);
    EXPECT_EQ(parts[0].euler + parts[1].euler + parts[2].euler, topology.euler);
}

TEST(Parts, KnowTheCylindersWovenFromThem) {
    const auto torus = geometry::make_sample("torus", 800);
    const geometry::Mesh mesh = beside({torus, torus});
    const geometry::Topology topology = geometry::analyse_topology(mesh);
    std::vector<Part> parts = parts_of(mesh, topology);
    std::vector<geometry::Cylinder> cylinders(3);
    cylinders[0].source_vertex = {-1, static_cast<int>(mesh.n_vertices()) - 1};
    cylinders[1].source_vertex = {0, -1};
    cylinders[2].source_vertex = {static_cast<int>(torus.positions.size())};
    assign_cylinders(mesh, topology, cylinders, parts);
    EXPECT_EQ(parts[0].cylinders, std::vector<int>{1});
    EXPECT_EQ(parts[1].cylinders, (std::vector<int>{0, 2}));
}

}  // namespace
}  // namespace leafcutter::fab
