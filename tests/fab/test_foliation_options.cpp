#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fab/foliation_options.h"
#include "geometry/error.h"

namespace leafcutter::fab {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// A file of 8 vertices, the first of which is used by nothing and the second twice there.
const std::vector<int> kVertexOfInput = {-1, 0, 0, 1, 2, 3, 4, 5};

geometry::Topology two_loops() {
    geometry::Topology topology;
    topology.boundary_loops = {{0, 1, 2}, {3, 4}};
    return topology;
}

geometry::FoliationOptions translated(const FoliationParams& params) {
    const geometry::Topology topology = two_loops();
    return foliation_options(params, {kVertexOfInput, topology});
}

std::string refusal(const FoliationParams& params) {
    try {
        translated(params);
    } catch (const geometry::Error& error) {
        EXPECT_EQ(error.kind(), geometry::ErrorKind::BadOption);
        return error.what();
    }
    return {};
}

TEST(FoliationOptions, NumberVerticesAsTheMeshDoes) {
    FoliationParams params;
    params.corners = {7, 6, 5, 4};
    params.poles = {3, 7};
    params.loops = {{2, 3, 4}};
    params.near = {{.vertex = 5, .position = {}}};
    params.forbid = {{5, 6, 7}};
    params.punctures = {{6, 2.5}};
    const geometry::FoliationOptions options = translated(params);
    EXPECT_EQ(options.corners, (std::array<int, 4>{5, 4, 3, 2}));
    EXPECT_EQ(options.poles, (std::array<int, 2>{1, 5}));
    EXPECT_EQ(options.loops, (std::vector<std::vector<int>>{{0, 1, 2}}));
    EXPECT_EQ(options.near, std::vector<int>{3});
    EXPECT_EQ(options.forbidden_loops, (std::vector<std::vector<int>>{{3, 4, 5}}));
    ASSERT_EQ(options.punctures.size(), 1U);
    EXPECT_EQ(options.punctures[0].vertex, 4);
    EXPECT_EQ(options.punctures[0].radius, 2.5);
}

TEST(FoliationOptions, TakeOverWhatNamesNoVertices) {
    FoliationParams params;
    params.mode = geometry::FoliationMode::Pants;
    params.torus_rings = geometry::TorusRings::Long;
    params.pants = geometry::PantsSource::TunnelLoops;
    params.function = geometry::SweepFunction::Y;
    params.weights = {1.0, 3.0};
    params.puncture = geometry::PunctureChoice::None;
    params.components = geometry::Components::Largest;
    const geometry::FoliationOptions options = translated(params);
    EXPECT_EQ(options.mode, params.mode);
    EXPECT_EQ(options.torus_rings, params.torus_rings);
    EXPECT_EQ(options.pants, params.pants);
    EXPECT_EQ(options.function, params.function);
    EXPECT_EQ(options.weights, params.weights);
    EXPECT_EQ(options.puncture, params.puncture);
    EXPECT_EQ(options.components, params.components);
}

TEST(FoliationOptions, FindLoopsByNumberAndByVertices) {
    FoliationParams params;
    params.sources = {{.number = 1, .vertices = {}}};
    params.sinks = {{.number = {}, .vertices = {4, 3}}};
    const geometry::FoliationOptions options = translated(params);
    ASSERT_EQ(options.sources.size(), 1U);
    EXPECT_EQ(options.sources[0].number, 1);
    ASSERT_EQ(options.sinks.size(), 1U);
    EXPECT_EQ(options.sinks[0].vertex, 2);
}

TEST(FoliationOptions, NumberLoopsOfGivenHolesAfterThoseOfTheModel) {
    FoliationParams params;
    params.sinks = {{.number = 2, .vertices = {}}};
    EXPECT_THAT(refusal(params), StartsWith("foliation.sinks[0]: there is no boundary loop 2; "
                                            "there are 2"));
    params.puncture = geometry::PunctureChoice::Given;
    params.punctures = {{7, 1.0}};
    EXPECT_EQ(translated(params).sinks[0].number, 2);
}

TEST(FoliationOptions, NameTheVertexThatIsNotThere) {
    FoliationParams params;
    params.poles = {3, 8};
    EXPECT_EQ(refusal(params), "foliation.poles[1]: the model has no vertex 8; it has 8");
    params = {};
    params.loops = {{3, 4, 5}, {3, 0, 4}};
    EXPECT_EQ(refusal(params), "foliation.loops[1][1]: vertex 0 belongs to no face that was kept");
    params = {};
    params.punctures = {{9, 1.0}};
    EXPECT_THAT(refusal(params), StartsWith("foliation.punctures[0].vertex: "));
    params = {};
    params.near = {{.vertex = 3, .position = {}}, {.vertex = 100, .position = {}}};
    EXPECT_THAT(refusal(params), StartsWith("foliation.singularities[1].near: "));
}

// Vertices 1 and 2 of the file are one of the mesh.
TEST(FoliationOptions, RefuseTheSamePlaceTwice) {
    FoliationParams params;
    params.near = {{.vertex = 1, .position = {}}, {.vertex = 2, .position = {}}};
    EXPECT_EQ(refusal(params),
              "foliation.singularities[1].near: the same vertex of the model as singularities[0]");
}

TEST(FoliationOptions, FindTheVertexNearestToAPositionOfTheFile) {
    geometry::Mesh mesh;
    const double scale = 10.0;
    for (const Eigen::Vector3d& corner :
         {Eigen::Vector3d{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}) {
        mesh.add_vertex(scale * corner);
    }
    FoliationParams params;
    params.near = {{.vertex = {}, .position = {0.1, 0.8, -0.2}},
                   {.vertex = {}, .position = {9.0, 0.0, 8.0}}};
    const geometry::Topology topology = two_loops();
    const geometry::FoliationOptions options =
        foliation_options(params, {kVertexOfInput, topology, &mesh, scale});
    EXPECT_EQ(options.near, (std::vector<int>{2, 1}));
}

TEST(FoliationOptions, RefuseVerticesOfSeveralLoopsOrNone) {
    FoliationParams params;
    params.sources = {{.number = {}, .vertices = {3, 5}}};
    EXPECT_THAT(refusal(params), HasSubstr("foliation.sources[0][1]: vertex 5 lies on another"));
    params.sources = {{.number = {}, .vertices = {7}}};
    EXPECT_THAT(refusal(params), HasSubstr("vertex 7 lies on no boundary loop"));
}

TEST(InputOfVertices, TakesTheFirstOfSeveralNumbers) {
    EXPECT_EQ(input_of_vertices(kVertexOfInput, 7), (std::vector<int>{1, 3, 4, 5, 6, 7, -1}));
}

}  // namespace
}  // namespace leafcutter::fab
