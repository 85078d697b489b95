#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "geometry/repair.h"
#include "geometry/topology.h"
#include "tests/support/mesh_text.h"

namespace leafcutter::geometry {
namespace {

constexpr std::string_view kTetrahedron =
    "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

// A square annulus of 8 triangles in the plane, counter-clockwise.
constexpr std::string_view kAnnulus =
    "OFF\n8 4 0\n0 0 0\n3 0 0\n3 3 0\n0 3 0\n1 1 0\n2 1 0\n2 2 0\n1 2 0\n"
    "4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";

Topology topology_of(std::string_view text) {
    return analyse_topology(repair(test::read_text(text, "a.off")).mesh);
}

TEST(Topology, CountsAClosedSphere) {
    const Topology topology = topology_of(kTetrahedron);
    EXPECT_EQ(topology.vertices, 4);
    EXPECT_EQ(topology.edges, 6);
    EXPECT_EQ(topology.faces, 4);
    EXPECT_EQ(topology.components, 1);
    EXPECT_EQ(topology.euler, 2);
    EXPECT_EQ(topology.genus, 0);
    EXPECT_TRUE(topology.boundary_loops.empty());
}

TEST(Topology, BoundaryLoopsHaveTheSurfaceToTheirLeft) {
    const RepairedMesh repaired = repair(test::read_text(kAnnulus, "a.off"));
    const Topology topology = analyse_topology(repaired.mesh);
    ASSERT_EQ(topology.boundary_loops.size(), 2U);
    for (const std::vector<int>& loop : topology.boundary_loops) {
        ASSERT_EQ(loop.size(), 4U);
        double twice_area = 0.0;
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const auto p = repaired.mesh.point(Mesh::VertexHandle(loop[i]));
            const auto q = repaired.mesh.point(Mesh::VertexHandle(loop[(i + 1) % loop.size()]));
            twice_area += p.x() * q.y() - p.y() * q.x();
        }
        const bool outer = *std::min_element(loop.begin(), loop.end()) == 0;
        EXPECT_DOUBLE_EQ(twice_area, outer ? 18.0 : -2.0);
    }
}

TEST(Topology, SumsOverComponents) {
    const Topology topology = topology_of(
        "OFF\n11 8 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n5 0 0\n6 0 0\n5 1 0\n5 0 1\n9 0 0\n10 0 0\n9 1 "
        "0\n"
        "3 0 2 1\n3 4 6 5\n3 0 1 3\n3 4 5 7\n3 1 2 3\n3 5 6 7\n3 2 0 3\n3 6 4 7\n");
    EXPECT_EQ(topology.components, 2);
    EXPECT_EQ(topology.euler, 4);
    EXPECT_EQ(topology.genus, 0);
    for (std::size_t face = 0; face < topology.component_of_face.size(); ++face) {
        EXPECT_EQ(topology.component_of_face[face], static_cast<int>(face % 2));
    }
}

TEST(Topology, TriangleMeshKeepsCornersInOrder) {
    const PolygonSoup soup = test::read_text(kTetrahedron, "a.off");
    const TriangleMesh mesh = to_triangle_mesh(repair(soup).mesh);
    ASSERT_EQ(mesh.triangles.size(), 4U);
    EXPECT_EQ(mesh.positions, soup.positions);
    for (std::size_t face = 0; face < 4; ++face) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            EXPECT_EQ(mesh.triangles[face][corner],
                      static_cast<int>(soup.corners[3 * face + corner]));
        }
    }
}

}  // namespace
}  // namespace leafcutter::geometry
