// Round holes: where, how large, how finely cut, and what is refused.

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/half_edges.h"
#include "geometry/punctures.h"
#include "geometry/samples.h"
#include "geometry/surface_distance.h"
#include "geometry/surface_measures.h"
#include "geometry/topology.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;
using testing::to_mesh;

int nearest_vertex(const TriangleMesh& mesh, const Eigen::Vector3d& point) {
    std::size_t best = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        if ((mesh.positions[v] - point).norm() < (mesh.positions[best] - point).norm()) {
            best = v;
        }
    }
    return static_cast<int>(best);
}

// What every opened mesh must be.
void expect_holes(const TriangleMesh& mesh, const OpenedMesh& opened) {
    const Topology before = analyse_topology(to_mesh(mesh));
    const Topology after = analyse_topology(to_mesh(opened.mesh));
    const int holes = static_cast<int>(opened.loops.size());
    EXPECT_EQ(after.euler, before.euler - holes);
    EXPECT_EQ(after.boundary_loops.size(), before.boundary_loops.size() + opened.loops.size());
    EXPECT_EQ(after.genus, before.genus);
    EXPECT_EQ(after.components, before.components);
    EXPECT_NEAR(surface_area(opened.mesh) + opened.removed_area, surface_area(mesh),
                1e-9 * surface_area(mesh));
    ASSERT_EQ(opened.source_vertex.size(), opened.mesh.positions.size());
    std::size_t kept = 0;
    for (std::size_t v = 0; v < opened.source_vertex.size(); ++v) {
        if (opened.source_vertex[v] >= 0) {
            EXPECT_EQ(opened.mesh.positions[v], mesh.positions[at(opened.source_vertex[v])]);
            ++kept;
        }
    }
    EXPECT_LE(kept, mesh.positions.size());
    ASSERT_EQ(opened.punctures.size(), opened.loops.size());
    for (const std::vector<int>& loop : opened.loops) {
        EXPECT_GE(loop.size(), 32U);
    }
}

TEST(Punctures, OpensARoundHoleOfTheRadiusAskedFor) {
    const TriangleMesh square = testing::make_square(10);
    const int middle = nearest_vertex(square, {0.5, 0.5, 0.0});
    for (const double radius : {0.02, 0.1, 0.25}) {
        const std::vector<Puncture> punctures{{middle, radius}};
        const OpenedMesh opened = open_punctures(square, punctures, {});
        expect_holes(square, opened);
        EXPECT_NEAR(opened.removed_area, std::numbers::pi * radius * radius,
                    0.04 * radius * radius);
        for (const int v : opened.loops[0]) {
            EXPECT_NEAR((opened.mesh.positions[at(v)] - square.positions[at(middle)]).norm(),
                        radius, 0.07 * radius);
        }
    }
}

TEST(Punctures, SurfaceLiesLeftOfEachHolesLoop) {
    const TriangleMesh square = testing::make_square(10);
    const std::vector<Puncture> punctures{{nearest_vertex(square, {0.5, 0.5, 0.0}), 0.1}};
    const OpenedMesh opened = open_punctures(square, punctures, {});
    double turns = 0.0;
    const std::vector<int>& loop = opened.loops[0];
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Eigen::Vector3d p = opened.mesh.positions[at(loop[i])] - Eigen::Vector3d(0.5, 0.5, 0);
        const Eigen::Vector3d q =
            opened.mesh.positions[at(loop[(i + 1) % loop.size()])] - Eigen::Vector3d(0.5, 0.5, 0);
        turns += std::atan2(p.cross(q).z(), p.dot(q)) / (2.0 * std::numbers::pi);
    }
    EXPECT_NEAR(turns, -1.0, 1e-9);
}

TEST(Punctures, OpensSeveralHolesInAnySurface) {
    for (const char* name : {"sphere", "torus", "eight"}) {
        const TriangleMesh mesh = make_sample(name, 3000);
        std::vector<Puncture> punctures;
        const double radius = 0.03 * std::sqrt(surface_area(mesh));
        for (std::size_t k = 0; k < 5; ++k) {
            punctures.push_back({static_cast<int>(k * mesh.positions.size() / 5), radius});
        }
        const OpenedMesh opened = open_punctures(mesh, punctures, {}, PunctureFit::Shrink);
        SCOPED_TRACE(name);
        EXPECT_EQ(opened.loops.size(), 5U);
        expect_holes(mesh, opened);
    }
}

TEST(Punctures, SurvivesNeedlesAndRoughSurfaces) {
    std::minstd_rand random(7);
    TriangleMesh mesh = testing::make_torus(24, 60, 0.3);
    testing::add_needles(mesh, 300, random);
    testing::jitter(mesh, 0.01, random);
    std::vector<Puncture> punctures;
    for (int k = 0; k < 6; ++k) {
        punctures.push_back({k * 230, 0.08});
    }
    expect_holes(mesh, open_punctures(mesh, punctures, {}, PunctureFit::Shrink));
}

std::string refusal(const TriangleMesh& mesh, const std::vector<Puncture>& punctures) {
    try {
        open_punctures(mesh, punctures, {});
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::BadOption);
        EXPECT_EQ(error.code(), "bad-puncture");
        return error.what();
    }
    return "";
}

// The radius that a refusal proposes.
double proposed(const std::string& message) {
    const std::string key = "a radius of ";
    const std::size_t place = message.find(key);
    return place == std::string::npos ? 0.0 : std::stod(message.substr(place + key.size()));
}

TEST(Punctures, ProposesARadiusThatWouldDo) {
    const TriangleMesh square = testing::make_square(20);
    const int middle = nearest_vertex(square, {0.5, 0.5, 0.0});
    const int beside = nearest_vertex(square, {0.6, 0.5, 0.0});
    const TriangleMesh tube = testing::make_torus(24, 90, 0.2);
    struct Case {
        const TriangleMesh* mesh;
        std::vector<Puncture> punctures;
        std::string names;
    };
    const std::vector<Case> cases{
        {&square, {{middle, 0.45}}, "[0]: its hole comes too near to a boundary"},
        {&square, {{middle, 0.06}, {beside, 0.05}}, "[1]: its hole comes too near to that of [0]"},
        {&tube, {{5, 0.1}, {900, 0.9}}, "[1]: what it cuts out is no disk"}};
    for (const Case& c : cases) {
        const std::string message = refusal(*c.mesh, c.punctures);
        EXPECT_NE(message.find(c.names), std::string::npos) << message;
        ASSERT_GT(proposed(message), 0.0) << message;
        std::vector<Puncture> smaller = c.punctures;
        for (Puncture& puncture : smaller) {
            puncture.radius = std::min(puncture.radius, proposed(message));
        }
        expect_holes(*c.mesh, open_punctures(*c.mesh, smaller, {}));
    }
}

TEST(Punctures, RefusesWhatIsNoPlaceOrNoRadius) {
    const TriangleMesh square = testing::make_square(10);
    const int middle = nearest_vertex(square, {0.5, 0.5, 0.0});
    EXPECT_NE(refusal(square, {{-1, 0.1}}).find("no vertex -1"), std::string::npos);
    EXPECT_NE(refusal(square, {{100000, 0.1}}).find("no vertex 100000"), std::string::npos);
    EXPECT_NE(refusal(square, {{middle, 0.0}}).find("radius must be"), std::string::npos);
    EXPECT_NE(refusal(square, {{middle, std::nan("")}}).find("radius must be"), std::string::npos);
    EXPECT_NE(refusal(square, {{middle, 0.1}, {middle, 0.05}}).find("that of [0]"),
              std::string::npos);
    EXPECT_NE(refusal(square, {{0, 0.1}}).find("choose another vertex"), std::string::npos);
}

TEST(Punctures, GivesUpOnlyWhatCannotFit) {
    const TriangleMesh square = testing::make_square(10);
    const std::vector<Puncture> punctures{{0, 0.1},
                                          {nearest_vertex(square, {0.5, 0.5, 0.0}), 0.45}};
    const OpenedMesh opened = open_punctures(square, punctures, {}, PunctureFit::Shrink);
    ASSERT_EQ(opened.punctures.size(), 1U);
    EXPECT_EQ(opened.punctures[0].vertex, punctures[1].vertex);
    EXPECT_LT(opened.punctures[0].radius, 0.45);
    EXPECT_GT(opened.punctures[0].radius, 0.3);
    expect_holes(square, opened);
}

TEST(SurfaceDistance, IsTheStraightLineInThePlane) {
    const TriangleMesh square = testing::make_square(16);
    const int corner = nearest_vertex(square, {0.0, 0.0, 0.0});
    SurfaceDistance distances(square);
    const auto reached = distances.from(std::span(&corner, 1));
    ASSERT_EQ(reached.size(), square.positions.size());
    double last = 0.0;
    for (const auto& [v, distance] : reached) {
        EXPECT_NEAR(distance, square.positions[at(v)].norm(), 0.01);
        EXPECT_GE(distance, last);
        last = distance;
    }
}

}  // namespace
}  // namespace leafcutter::geometry
