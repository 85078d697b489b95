#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/repair.h"
#include "geometry/samples.h"
#include "geometry/topology.h"
#include "tests/support/mesh_text.h"

namespace leafcutter::geometry {
namespace {

struct Known {
    int genus;
    std::size_t boundary_loops;
};

const std::map<std::string_view, Known> kKnown{
    {"eight", {2, 0}},  {"double-torus", {2, 0}}, {"torus", {1, 0}}, {"sphere", {0, 0}},
    {"hand", {0, 1}},   {"face", {0, 1}},         {"vase", {0, 2}},  {"cylinder", {0, 2}},
    {"square", {0, 1}}, {"saddle", {0, 1}}};

PolygonSoup soup_of(const TriangleMesh& mesh) {
    PolygonSoup soup;
    soup.positions = mesh.positions;
    soup.face_offsets.push_back(0);
    for (const auto& triangle : mesh.triangles) {
        for (const int vertex : triangle) {
            soup.corners.push_back(static_cast<std::uint32_t>(vertex));
        }
        soup.face_offsets.push_back(static_cast<std::uint32_t>(soup.corners.size()));
    }
    return soup;
}

// 1 for an equilateral triangle, 0 for a degenerate one.
double quality(const TriangleMesh& mesh, const std::array<int, 3>& t) {
    const auto p = [&](std::size_t i) { return mesh.positions[static_cast<std::size_t>(t[i])]; };
    const double area = (p(1) - p(0)).cross(p(2) - p(0)).norm() / 2.0;
    return 4.0 * std::sqrt(3.0) * area /
           ((p(1) - p(0)).squaredNorm() + (p(2) - p(1)).squaredNorm() +
            (p(0) - p(2)).squaredNorm());
}

double signed_volume(const TriangleMesh& mesh) {
    double volume = 0.0;
    for (const auto& t : mesh.triangles) {
        const auto p = [&](std::size_t i) {
            return mesh.positions[static_cast<std::size_t>(t[i])];
        };
        volume += p(0).dot(p(1).cross(p(2))) / 6.0;
    }
    return volume;
}

class EverySample : public testing::TestWithParam<std::tuple<std::string_view, int>> {
protected:
    TriangleMesh mesh_ = make_sample(std::get<0>(GetParam()), std::get<1>(GetParam()));
};

TEST_P(EverySample, HasItsTopologyAndNeedsNoRepair) {
    const Known known = kKnown.at(std::get<0>(GetParam()));
    const RepairedMesh repaired = repair(soup_of(mesh_));
    const Topology topology = analyse_topology(repaired.mesh);
    EXPECT_EQ(topology.components, 1);
    EXPECT_EQ(topology.genus, known.genus);
    EXPECT_EQ(topology.boundary_loops.size(), known.boundary_loops);
    EXPECT_EQ(topology.vertices, static_cast<int>(mesh_.positions.size()));
    EXPECT_EQ(topology.faces, static_cast<int>(mesh_.triangles.size()));
    EXPECT_EQ(repaired.report.faces_reoriented, 0U);
    EXPECT_TRUE(repaired.report.warnings.empty());
}

TEST_P(EverySample, HasAboutTheFacesAskedFor) {
    const auto wanted = static_cast<std::size_t>(std::get<1>(GetParam()));
    EXPECT_GE(2 * mesh_.triangles.size(), wanted);
    EXPECT_LE(mesh_.triangles.size(), 2 * wanted);
}

TEST_P(EverySample, IsMadeOfWellShapedTriangles) {
    double sum = 0.0;
    double least = 1.0;
    for (const auto& triangle : mesh_.triangles) {
        sum += quality(mesh_, triangle);
        least = std::min(least, quality(mesh_, triangle));
    }
    EXPECT_GT(sum / static_cast<double>(mesh_.triangles.size()), 0.8);
    EXPECT_GT(least, 0.4);
}

TEST_P(EverySample, IsTheSameEachTime) {
    const TriangleMesh again = make_sample(std::get<0>(GetParam()), std::get<1>(GetParam()));
    EXPECT_EQ(again.positions, mesh_.positions);
    EXPECT_EQ(again.triangles, mesh_.triangles);
}

INSTANTIATE_TEST_SUITE_P(Samples,
                         EverySample,
                         testing::Combine(testing::ValuesIn(sample_names().begin(),
                                                            sample_names().end()),
                                          testing::Values(1500, 5000)),
                         [](const auto& sample) {
                             std::string name(std::get<0>(sample.param));
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name + "_" + std::to_string(std::get<1>(sample.param));
                         });

TEST(Samples, ClosedOnesFaceOutward) {
    for (const auto& [name, known] : kKnown) {
        if (known.boundary_loops == 0) {
            EXPECT_GT(signed_volume(make_sample(name, 2000)), 0.0) << name;
        }
    }
}

TEST(Samples, ATorusHasTheVolumeOfItsFormula) {
    const double exact = 2.0 * std::pow(std::acos(-1.0), 2) * 1.0 * 0.4 * 0.4;
    EXPECT_NEAR(signed_volume(make_sample("torus", 20000)), exact, 0.005 * exact);
}

TEST(Samples, ASphereLiesOnItsSphere) {
    for (const Eigen::Vector3d& p : make_sample("sphere", 2000).positions) {
        EXPECT_NEAR(p.norm(), 1.0, 1e-9);
    }
}

TEST(Samples, TheHandIsCutFlatAtTheWrist) {
    const TriangleMesh mesh = make_sample("hand", 3000);
    const Topology topology = analyse_topology(repair(soup_of(mesh)).mesh);
    for (const int vertex : topology.boundary_loops.at(0)) {
        EXPECT_NEAR(mesh.positions[static_cast<std::size_t>(vertex)].z(), 0.0, 1e-12);
    }
}

TEST(Samples, UnknownNamesAndTooFewFacesAreRefused) {
    EXPECT_EQ(test::error_of([] { make_sample("klein-bottle"); }).kind(), ErrorKind::BadOption);
    EXPECT_EQ(test::error_of([] { make_sample("torus", 99); }).kind(), ErrorKind::BadOption);
}

}  // namespace
}  // namespace leafcutter::geometry
