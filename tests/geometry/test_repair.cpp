#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/repair.h"
#include "geometry/topology.h"
#include "tests/support/mesh_text.h"

namespace leafcutter::geometry {
namespace {

using testing::HasSubstr;

using Face = std::vector<std::uint32_t>;

PolygonSoup soup_of(std::vector<Eigen::Vector3d> positions, const std::vector<Face>& faces) {
    PolygonSoup soup;
    soup.positions = std::move(positions);
    soup.face_offsets.push_back(0);
    for (const Face& face : faces) {
        soup.corners.insert(soup.corners.end(), face.begin(), face.end());
        soup.face_offsets.push_back(static_cast<std::uint32_t>(soup.corners.size()));
    }
    return soup;
}

// As STL stores it: no vertex shared. `noise` shifts each corner by up to that much.
PolygonSoup exploded(const PolygonSoup& soup, double noise = 0.0) {
    PolygonSoup result;
    result.face_offsets = soup.face_offsets;
    for (const std::uint32_t corner : soup.corners) {
        const auto n = static_cast<double>(result.positions.size());
        const Eigen::Vector3d shift(std::sin(7 * n), std::sin(11 * n), std::sin(13 * n));
        result.corners.push_back(static_cast<std::uint32_t>(result.positions.size()));
        result.positions.push_back(soup.positions[corner] + noise * shift);
    }
    return result;
}

PolygonSoup cube() {
    std::vector<Eigen::Vector3d> positions;
    for (int i = 0; i < 8; ++i) {
        positions.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
    }
    return soup_of(
        positions,
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}});
}

// A strip of `quads` quads bent into a ring with so many half twists.
PolygonSoup ring(std::uint32_t quads, int half_twists) {
    std::vector<Eigen::Vector3d> positions;
    std::vector<Face> faces;
    for (std::uint32_t i = 0; i < quads; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / quads;
        const Eigen::Vector3d outward(std::cos(angle), std::sin(angle), 0.0);
        const double twist = half_twists * angle / 2.0;
        const Eigen::Vector3d across =
            0.3 * (std::cos(twist) * outward + std::sin(twist) * Eigen::Vector3d::UnitZ());
        positions.push_back(outward - across);
        positions.push_back(outward + across);
        const bool last = i + 1 == quads;
        const bool crossed = last && half_twists % 2 != 0;
        const std::uint32_t next = last ? 0 : 2 * i + 2;
        faces.push_back({2 * i, 2 * i + 1, next + (crossed ? 0 : 1), next + (crossed ? 1 : 0)});
    }
    return soup_of(positions, faces);
}

double area_of(const Mesh& mesh) {
    double area = 0.0;
    for (const auto face : mesh.faces()) {
        area += mesh.calc_face_area(face);
    }
    return area;
}

double volume_of(const Mesh& mesh) {
    const TriangleMesh triangles = to_triangle_mesh(mesh);
    double volume = 0.0;
    for (const auto& [a, b, c] : triangles.triangles) {
        const auto p = [&](int v) { return triangles.positions[static_cast<std::size_t>(v)]; };
        volume += p(a).dot(p(b).cross(p(c))) / 6.0;
    }
    return volume;
}

void expect_closed_unit_cube(const RepairedMesh& repaired) {
    const Topology topology = analyse_topology(repaired.mesh);
    EXPECT_EQ(topology.vertices, 8);
    EXPECT_EQ(topology.faces, 12);
    EXPECT_EQ(topology.components, 1);
    EXPECT_TRUE(topology.boundary_loops.empty());
    EXPECT_NEAR(volume_of(repaired.mesh), 1.0, 1e-4);
}

std::string code_of(const PolygonSoup& soup) {
    return test::error_of([&] { repair(soup); }).code();
}

TEST(Repair, LeavesAProperMeshAsItIs) {
    const RepairedMesh repaired = repair(cube());
    expect_closed_unit_cube(repaired);
    EXPECT_EQ(repaired.report.triangulated_polygons, 6U);
    EXPECT_EQ(repaired.report.welded_vertices, 0U);
    EXPECT_EQ(repaired.report.faces_reoriented, 0U);
    EXPECT_TRUE(repaired.report.warnings.empty());
    for (int vertex = 0; vertex < 8; ++vertex) {
        EXPECT_EQ(repaired.vertex_of_input[static_cast<std::size_t>(vertex)], vertex);
    }
}

TEST(Repair, WeldsFacesStoredApart) {
    const RepairedMesh repaired = repair(exploded(cube()));
    expect_closed_unit_cube(repaired);
    EXPECT_EQ(repaired.report.welded_vertices, 16U);
    const PolygonSoup stored = exploded(cube());
    for (std::size_t vertex = 0; vertex < stored.positions.size(); ++vertex) {
        const auto handle = Mesh::VertexHandle(repaired.vertex_of_input[vertex]);
        EXPECT_EQ(repaired.mesh.point(handle), stored.positions[vertex]);
    }
}

TEST(Repair, WeldsWithinRoundingAtAnyScale) {
    for (const double scale : {1e-9, 1.0, 1e9}) {
        PolygonSoup soup = exploded(cube(), 1e-7);
        for (Eigen::Vector3d& p : soup.positions) {
            p *= scale;
        }
        const RepairedMesh repaired = repair(soup);
        EXPECT_EQ(repaired.mesh.n_vertices(), 8U) << scale;
        EXPECT_TRUE(analyse_topology(repaired.mesh).boundary_loops.empty()) << scale;
    }
}

TEST(Repair, DoesNotWeldAcrossAGap) {
    EXPECT_EQ(analyse_topology(repair(exploded(cube(), 1e-3)).mesh).components, 6);
}

TEST(Repair, DoesNotWeldClosedSurfacesThatTouch) {
    PolygonSoup two = cube();
    for (const std::uint32_t corner : cube().corners) {
        two.corners.push_back(corner + 8);
    }
    for (std::size_t face = 0; face < 6; ++face) {
        two.face_offsets.push_back(two.face_offsets.back() + 4);
    }
    for (const Eigen::Vector3d& p : cube().positions) {
        two.positions.push_back(p + Eigen::Vector3d::UnitX());
    }
    const RepairedMesh repaired = repair(two);
    EXPECT_EQ(repaired.report.welded_vertices, 0U);
    EXPECT_EQ(analyse_topology(repaired.mesh).components, 2);
}

// A grid of quads whose inner edges 6 - 7 - 8 are stored twice: a slit.
PolygonSoup slit_square() {
    std::vector<Eigen::Vector3d> positions;
    for (int i = 0; i < 20; ++i) {
        positions.emplace_back(i % 5, i / 5, 0.0);
    }
    std::vector<Face> faces;
    for (std::uint32_t row = 0; row < 3; ++row) {
        for (std::uint32_t column = 0; column < 4; ++column) {
            const std::uint32_t a = 5 * row + column;
            faces.push_back({a, a + 1, a + 6, a + 5});
        }
    }
    positions.push_back(positions[7]);  // The middle of 6 - 7 - 8, once more for the faces above.
    for (Face& face : faces) {
        if (face[0] == 6 || face[0] == 7) {
            for (std::uint32_t& corner : face) {
                corner = corner == 7 ? 20 : corner;
            }
        }
    }
    return soup_of(positions, faces);
}

TEST(Repair, KeepsASlitInAnOpenSurface) {
    const RepairedMesh repaired = repair(slit_square());
    EXPECT_EQ(analyse_topology(repaired.mesh).boundary_loops.size(), 2U);
    EXPECT_EQ(repaired.report.welded_vertices, 0U);
    EXPECT_EQ(repaired.report.warnings.size(), 1U);
}

TEST(Repair, ClosesTheSeamOfASurfaceThatIsClosedWithoutIt) {
    PolygonSoup soup = slit_square();
    soup.positions.emplace_back(2.0, 1.5, -3.0);  // A fan below closes the outer rim.
    const Face rim{0, 1, 2, 3, 4, 9, 14, 19, 18, 17, 16, 15, 10, 5};
    for (std::size_t i = 0; i < rim.size(); ++i) {
        soup.corners.insert(soup.corners.end(), {rim[(i + 1) % rim.size()], rim[i], 21});
        soup.face_offsets.push_back(static_cast<std::uint32_t>(soup.corners.size()));
    }
    const RepairedMesh repaired = repair(soup);
    EXPECT_TRUE(analyse_topology(repaired.mesh).boundary_loops.empty());
    EXPECT_EQ(repaired.report.welded_vertices, 1U);
}

TEST(Repair, ClosesTheSeamOfARolledUpTube) {
    std::vector<Eigen::Vector3d> positions;
    std::vector<Face> faces;
    for (std::uint32_t i = 0; i <= 8; ++i) {
        const double angle = 2.0 * std::numbers::pi * (i % 8) / 8.0;
        positions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
        positions.emplace_back(std::cos(angle), std::sin(angle), 1.0);
    }
    for (std::uint32_t i = 0; i < 8; ++i) {
        faces.push_back({2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
    }
    const RepairedMesh repaired = repair(soup_of(positions, faces));
    EXPECT_EQ(analyse_topology(repaired.mesh).boundary_loops.size(), 2U);
    EXPECT_EQ(repaired.report.welded_vertices, 2U);
}

TEST(Repair, DropsDuplicateFacesHoweverTheyAreListed) {
    PolygonSoup soup = cube();
    for (const std::uint32_t corner : {3U, 1U, 0U, 2U, /*the other way:*/ 6U, 7U, 5U, 4U}) {
        soup.corners.push_back(corner);
    }
    soup.face_offsets.insert(soup.face_offsets.end(), {28, 32});
    const RepairedMesh repaired = repair(soup);
    expect_closed_unit_cube(repaired);
    EXPECT_EQ(repaired.report.duplicate_faces_dropped, 2U);
}

TEST(Repair, DropsDegenerateFacesAndUnusedVertices) {
    PolygonSoup soup = cube();
    soup.positions.emplace_back(9, 9, 9);
    soup.corners.insert(soup.corners.end(), {0, 0, 1});
    soup.face_offsets.push_back(27);
    const RepairedMesh repaired = repair(soup);
    expect_closed_unit_cube(repaired);
    EXPECT_EQ(repaired.report.degenerate_faces_dropped, 1U);
    EXPECT_EQ(repaired.report.unused_vertices_dropped, 1U);
    EXPECT_EQ(repaired.vertex_of_input[8], -1);
}

TEST(Repair, ContractsEdgesOfLengthZero) {
    PolygonSoup soup = cube();
    soup.positions.push_back(soup.positions[7]);  // Corner 7 of one face apart, joined by a sliver.
    soup.corners = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6,
                    7, 8, 3, 0, 4, 6, 2, 1, 3, 8, 5, 8, 7, 5};
    soup.face_offsets = {0, 4, 8, 12, 17, 21, 25, 28};
    const RepairedMesh repaired = repair(soup);
    expect_closed_unit_cube(repaired);
    EXPECT_EQ(repaired.report.welded_vertices, 1U);
}

TEST(Repair, OrientsShuffledFacesOutward) {
    for (const bool keep_first : {true, false}) {
        PolygonSoup soup = cube();
        for (std::size_t face = keep_first ? 1 : 0; face < 6; face += 2) {
            std::swap(soup.corners[4 * face + 1], soup.corners[4 * face + 3]);
        }
        const RepairedMesh repaired = repair(soup);
        expect_closed_unit_cube(repaired);
        EXPECT_GT(repaired.report.faces_reoriented, 0U);
    }
}

TEST(Repair, OrientsAnOpenSurfaceAsMostOfItsFaces) {
    PolygonSoup soup = ring(12, 0);
    const Face first = {soup.corners[3], soup.corners[2], soup.corners[1], soup.corners[0]};
    std::copy(first.begin(), first.end(), soup.corners.begin());
    const RepairedMesh repaired = repair(soup);
    EXPECT_EQ(repaired.report.faces_reoriented, 2U);
    for (const auto face : repaired.mesh.faces()) {
        EXPECT_GT(repaired.mesh.calc_face_normal(face).z(), 0.9);
    }
}

TEST(Repair, SplitsFansThatTouchInAVertex) {
    const RepairedMesh repaired = repair(
        soup_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}));
    EXPECT_EQ(repaired.report.split_vertices, 1U);
    EXPECT_EQ(analyse_topology(repaired.mesh).components, 2);
    EXPECT_EQ(repaired.mesh.n_vertices(), 6U);
}

TEST(Repair, RefusesNonManifoldEdgesWithCountAndPlace) {
    const Error error = test::error_of([] {
        repair(soup_of({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}},
                       {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}}));
    });
    EXPECT_EQ(error.kind(), ErrorKind::BadMesh);
    EXPECT_EQ(error.code(), "non-manifold-edges");
    EXPECT_THAT(error.what(), HasSubstr("(1)"));
    EXPECT_THAT(error.what(), HasSubstr("vertices 0 and 1"));
}

TEST(Repair, RefusesOneSidedSurfacesOnly) {
    EXPECT_EQ(code_of(ring(20, 1)), "not-orientable");
    EXPECT_EQ(code_of(ring(20, 3)), "not-orientable");
    EXPECT_EQ(analyse_topology(repair(ring(20, 2)).mesh).boundary_loops.size(), 2U);
}

TEST(Repair, RefusesSurfacesWithoutArea) {
    EXPECT_EQ(code_of({}), "no-faces");
    EXPECT_EQ(code_of(soup_of({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}, {{0, 1, 2}})), "zero-area");
    EXPECT_EQ(code_of(soup_of({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}})), "zero-area");
    EXPECT_EQ(code_of(soup_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 1}})), "zero-area");
    EXPECT_EQ(code_of(soup_of({{0, 0, 0}, {1e200, 0, 0}, {0, 1, 0}}, {{0, 1, 2}})), "degenerate");
}

TEST(Repair, TriangulatesConcavePolygonsWithoutOverlap) {
    for (const std::uint32_t spikes : {2U, 5U, 50U, 500U}) {
        std::vector<Eigen::Vector3d> star;
        Face face;
        for (std::uint32_t i = 0; i < 2 * spikes; ++i) {
            const double angle = std::numbers::pi * i / spikes;
            const double radius = i % 2 == 0 ? 1.0 : 0.3;
            const Eigen::Vector3d flat(radius * std::cos(angle), radius * std::sin(angle), 5.0);
            star.push_back(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()) * flat);
            face.push_back(i);
        }
        const RepairedMesh repaired = repair(soup_of(star, {face}));
        const double exact = spikes * 0.3 * std::sin(std::numbers::pi / spikes);
        EXPECT_EQ(repaired.mesh.n_faces(), 2 * spikes - 2);
        EXPECT_NEAR(area_of(repaired.mesh), exact, 1e-9 * exact) << spikes;
        EXPECT_EQ(analyse_topology(repaired.mesh).euler, 1);
    }
}

TEST(Repair, TriangulatesAPolygonWithStraightCorners) {
    std::vector<Eigen::Vector3d> outline;
    Face face;
    for (int side = 0; side < 4; ++side) {
        for (int step = 0; step < 5; ++step) {
            const Eigen::Vector3d p =
                Eigen::AngleAxisd(side * std::numbers::pi / 2.0, Eigen::Vector3d::UnitZ()) *
                Eigen::Vector3d(-1.0 + 0.4 * step, -1.0, 0.0);
            face.push_back(static_cast<std::uint32_t>(outline.size()));
            outline.push_back(p);
        }
    }
    const RepairedMesh repaired = repair(soup_of(outline, {face}));
    EXPECT_NEAR(area_of(repaired.mesh), 4.0, 1e-9);
    EXPECT_TRUE(repaired.report.warnings.empty());
}

TEST(Repair, HalvesADentedQuadAlongTheDiagonalInside) {
    for (std::uint32_t turn = 0; turn < 4; ++turn) {
        const std::vector<Eigen::Vector3d> dart{{0, 0, 0}, {2, -1, 0}, {0.5, 0, 0}, {2, 1, 0}};
        Face face;
        for (std::uint32_t i = 0; i < 4; ++i) {
            face.push_back((i + turn) % 4);
        }
        const RepairedMesh repaired = repair(soup_of(dart, {face}));
        EXPECT_NEAR(area_of(repaired.mesh), 0.5, 1e-12) << turn;
    }
}

TEST(Repair, EndsOnAPolygonThatCrossesItself) {
    std::vector<Eigen::Vector3d> tangle;
    Face face;
    for (std::uint32_t i = 0; i < 400; ++i) {
        tangle.emplace_back(std::sin(3.7 * i), std::cos(5.3 * i), std::sin(0.9 * i));
        face.push_back(i);
    }
    const RepairedMesh repaired = repair(soup_of(tangle, {face}));
    EXPECT_EQ(repaired.mesh.n_faces(), 398U);
    EXPECT_EQ(analyse_topology(repaired.mesh).euler, 1);
}

}  // namespace
}  // namespace leafcutter::geometry
