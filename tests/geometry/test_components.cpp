// Models of several parts: each woven for itself, or the largest alone; options that name vertices
// go to the part that has them.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/foliation.h"
#include "geometry/surface_measures.h"
#include "tests/geometry/chart_checks.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;
using testing::is_sound;
using testing::to_mesh;

// Side by side in one mesh.
TriangleMesh together(const std::vector<TriangleMesh>& parts) {
    TriangleMesh all;
    for (const TriangleMesh& part : parts) {
        const int offset = static_cast<int>(all.positions.size());
        for (const Eigen::Vector3d& p : part.positions) {
            all.positions.push_back(p + Eigen::Vector3d(5.0 * offset, 0.0, 0.0));
        }
        for (const auto& t : part.triangles) {
            all.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
        }
    }
    return all;
}

TriangleMesh three_parts() {
    return together({testing::make_square(6), testing::make_torus(12, 30, 0.3),
                     testing::make_prism(12, 6, 0.5, 1.0)});
}

std::string code_of(const TriangleMesh& mesh, const FoliationOptions& options) {
    try {
        compute_foliation(to_mesh(mesh), options);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::BadOption);
        return error.code();
    }
    return "";
}

TEST(Components, EachPartIsWovenForItself) {
    const TriangleMesh mesh = three_parts();
    const Foliation foliation = compute_foliation(to_mesh(mesh));
    ASSERT_EQ(foliation.cylinders.size(), 3U);
    EXPECT_EQ(foliation.cylinders[0].shape, ChartShape::Rectangle);
    EXPECT_EQ(foliation.cylinders[1].shape, ChartShape::Torus);
    EXPECT_EQ(foliation.cylinders[2].shape, ChartShape::Annulus);
    EXPECT_EQ(foliation.mode, FoliationMode::Torus);  // The largest part.
    EXPECT_EQ(foliation.graph.nodes, 5);
    ASSERT_EQ(foliation.graph.edges.size(), 3U);
    double area = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Cylinder& cylinder = foliation.cylinders[k];
        EXPECT_TRUE(is_sound(cylinder));
        EXPECT_EQ(cylinder.graph_edge, static_cast<int>(k));
        area += surface_area(cylinder.mesh);
        for (std::size_t v = 0; v < cylinder.source_vertex.size(); ++v) {
            if (cylinder.source_vertex[v] >= 0) {
                EXPECT_EQ(cylinder.mesh.positions[v],
                          mesh.positions[at(cylinder.source_vertex[v])]);
            }
        }
    }
    EXPECT_NEAR(area, surface_area(mesh), 1e-9 * area);
}

TEST(Components, AllChartsHaveOneUnit) {
    const Foliation foliation = compute_foliation(to_mesh(three_parts()));
    for (const Cylinder& cylinder : foliation.cylinders) {
        EXPECT_NEAR(cylinder.width * cylinder.height / surface_area(cylinder.mesh), 1.0, 1e-6);
        EXPECT_NEAR(foliation.graph.edges[at(cylinder.graph_edge)].weight, cylinder.height,
                    1e-9 * cylinder.height);
        EXPECT_NEAR(2.0 * cylinder.energy / (cylinder.width * cylinder.height), 1.0, 0.02);
    }
}

TEST(Components, APartIsTheSameAloneButForItsUnit) {
    const TriangleMesh ring = testing::make_prism(12, 6, 0.5, 1.0);
    const Cylinder alone = compute_foliation(to_mesh(ring)).cylinders[0];
    const Cylinder among = compute_foliation(to_mesh(three_parts())).cylinders[2];
    EXPECT_NEAR(among.width / among.height, alone.width / alone.height, 1e-9);
    EXPECT_EQ(among.mesh.triangles, alone.mesh.triangles);
}

TEST(Components, LargestLeavesTheOthersOutAndSaysSo) {
    const TriangleMesh mesh = three_parts();
    FoliationOptions options;
    options.components = Components::Largest;
    const Foliation foliation = compute_foliation(to_mesh(mesh), options);
    ASSERT_EQ(foliation.cylinders.size(), 1U);
    EXPECT_EQ(foliation.cylinders[0].shape, ChartShape::Torus);
    ASSERT_FALSE(foliation.warnings.empty());
    EXPECT_NE(foliation.warnings[0].find("2 smaller parts"), std::string::npos);
}

TEST(Components, CornersGoToTheirPart) {
    const TriangleMesh mesh = together({testing::make_square(6), testing::make_square(6)});
    FoliationOptions options;
    const int second = 49;  // Vertices of a square of 6 by 6.
    options.corners = {second, second + 3, second + 48, second + 42};
    const Foliation foliation = compute_foliation(to_mesh(mesh), options);
    // The left one is a square still, the right one no longer.
    EXPECT_NEAR(foliation.cylinders[0].width / foliation.cylinders[0].height, 1.0, 1e-6);
    EXPECT_GT(std::abs(foliation.cylinders[1].width / foliation.cylinders[1].height - 1.0), 0.05);
    options.corners = {0, 6, 48, second};
    EXPECT_EQ(code_of(mesh, options), "bad-corners");
}

TEST(Components, HolesGoToTheirPart) {
    const TriangleMesh mesh = together({testing::make_square(8), testing::make_square(8)});
    FoliationOptions options;
    options.puncture = PunctureChoice::Given;
    options.punctures = {{81 + 40, 0.2}};  // The middle of the second.
    const Foliation foliation = compute_foliation(to_mesh(mesh), options);
    ASSERT_EQ(foliation.cylinders.size(), 2U);
    EXPECT_EQ(foliation.cylinders[0].shape, ChartShape::Rectangle);
    EXPECT_EQ(foliation.cylinders[1].shape, ChartShape::Annulus);
    ASSERT_EQ(foliation.punctures.size(), 1U);
    EXPECT_EQ(foliation.punctures[0].vertex, 121);
    EXPECT_NEAR(surface_area(foliation.cylinders[1].mesh), 1.0 - 0.04 * std::acos(-1.0), 2e-3);
}

TEST(Components, RefusesWhatNamesNoPartOrAllOfThem) {
    const TriangleMesh mesh = three_parts();
    FoliationOptions options;
    options.weights = {1.0};
    EXPECT_EQ(code_of(mesh, options), "weights-of-several-parts");
    options = {};
    options.sources = {{.number = 3, .vertex = {}}};
    EXPECT_EQ(code_of(mesh, options), "no-such-loop");
    options = {};
    options.sinks = {{.number = {}, .vertex = 60}};  // On the torus.
    EXPECT_EQ(code_of(mesh, options), "no-such-loop");
    options = {};
    options.poles = {0, 100};
    EXPECT_EQ(code_of(mesh, options), "bad-poles");
}

TEST(Components, ErrorsNameThePart) {
    TriangleMesh mesh = together({testing::make_square(6), testing::make_torus(12, 30, 0.3)});
    FoliationOptions options;
    options.mode = FoliationMode::Disk;
    try {
        compute_foliation(to_mesh(mesh), options);
        FAIL() << "a torus is no disk";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), "mode-does-not-fit");
        EXPECT_EQ(std::string(error.what()).rfind("part 2 of 2: ", 0), 0U) << error.what();
    }
}

}  // namespace
}  // namespace leafcutter::geometry
