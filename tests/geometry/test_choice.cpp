// Which mode and which holes are chosen where nobody says.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/foliation.h"
#include "geometry/io/read_mesh.h"
#include "geometry/repair.h"
#include "geometry/samples.h"
#include "geometry/surface_measures.h"
#include "geometry/topology.h"
#include "tests/geometry/chart_checks.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;
using testing::is_sound;
using testing::to_mesh;

// What every foliation promises, whatever was chosen.
void expect_sound(const Mesh& mesh, const Foliation& foliation) {
    double area = 0.0;
    for (const Cylinder& cylinder : foliation.cylinders) {
        EXPECT_TRUE(is_sound(cylinder));
        area += surface_area(cylinder.mesh);
        for (std::size_t v = 0; v < cylinder.source_vertex.size(); ++v) {
            const int source = cylinder.source_vertex[v];
            if (source >= 0) {
                EXPECT_EQ(cylinder.mesh.positions[v], mesh.point(Mesh::VertexHandle(source)));
            }
        }
    }
    const double whole = surface_area(to_triangle_mesh(mesh));
    EXPECT_LE(area, whole * (1.0 + 1e-6));
    if (foliation.punctures.empty()) {
        EXPECT_GE(area, whole * (1.0 - 1e-6));
    }
    EXPECT_GT(foliation.spread.largest, 0.99);
    const auto chosen = std::count_if(foliation.alternatives.begin(), foliation.alternatives.end(),
                                      [](const Alternative& a) { return a.chosen; });
    EXPECT_EQ(chosen, foliation.alternatives.empty() ? 0 : 1);
}

TEST(Choice, AFingerOnAPlateIsOpenedAtItsTip) {
    const Mesh mesh = to_mesh(testing::make_finger(60, 2.0));
    const Foliation opened = compute_foliation(mesh);
    expect_sound(mesh, opened);
    EXPECT_EQ(opened.mode, FoliationMode::Annulus);
    ASSERT_EQ(opened.punctures.size(), 1U);
    EXPECT_GT(mesh.point(Mesh::VertexHandle(opened.punctures[0].vertex)).z(), 2.0);
    ASSERT_GE(opened.alternatives.size(), 2U);
    EXPECT_EQ(opened.alternatives[0].name, "disk");
    EXPECT_GT(opened.alternatives[0].spread.largest, 5.0 * opened.spread.largest);
    EXPECT_TRUE(
        std::any_of(opened.warnings.begin(), opened.warnings.end(), [](const std::string& warning) {
            return warning.find("1 hole is opened") != std::string::npos;
        }));

    FoliationOptions options;
    options.puncture = PunctureChoice::None;
    const Foliation whole = compute_foliation(mesh, options);
    EXPECT_EQ(whole.mode, FoliationMode::Disk);
    EXPECT_TRUE(whole.punctures.empty());
    EXPECT_FALSE(whole.warnings.empty());
}

TEST(Choice, EvenSurfacesStayWhole) {
    for (const char* name : {"square", "saddle", "face", "cylinder", "vase", "torus", "eight"}) {
        SCOPED_TRACE(name);
        const Mesh mesh = to_mesh(make_sample(name, 2500));
        const Foliation foliation = compute_foliation(mesh);
        expect_sound(mesh, foliation);
        EXPECT_TRUE(foliation.punctures.empty());
    }
}

TEST(Choice, ModesThatNeedHolesGetThem) {
    struct Case {
        TriangleMesh mesh;
        FoliationMode mode;
        std::size_t holes;
    };
    const std::vector<Case> cases{{make_sample("sphere", 2500), FoliationMode::Annulus, 2},
                                  {make_sample("sphere", 2500), FoliationMode::Pants, 3},
                                  {make_sample("sphere", 2500), FoliationMode::Disk, 1},
                                  {testing::make_square(24), FoliationMode::Annulus, 1},
                                  {testing::make_square(24), FoliationMode::Pants, 2},
                                  {testing::make_torus(16, 50, 0.3), FoliationMode::Pants, 1}};
    for (const Case& c : cases) {
        FoliationOptions options;
        options.mode = c.mode;
        const Mesh mesh = to_mesh(c.mesh);
        const Foliation foliation = compute_foliation(mesh, options);
        SCOPED_TRACE(c.holes);
        expect_sound(mesh, foliation);
        EXPECT_EQ(foliation.mode, c.mode);
        EXPECT_EQ(foliation.punctures.size(), c.holes);
    }
}

TEST(Choice, GivenHolesAreOpenedAndNoOthers) {
    const TriangleMesh square = testing::make_square(20);
    FoliationOptions options;
    options.puncture = PunctureChoice::Given;
    const int a = 5 * 21 + 5;
    const int b = 15 * 21 + 14;
    options.punctures = {{a, 0.08}, {b, 0.1}};
    const Mesh mesh = to_mesh(square);
    const Foliation foliation = compute_foliation(mesh, options);
    expect_sound(mesh, foliation);
    EXPECT_EQ(foliation.mode, FoliationMode::Pants);
    EXPECT_EQ(foliation.cylinders.size(), 3U);
    EXPECT_EQ(foliation.singularities.size(), 2U);
    ASSERT_EQ(foliation.punctures.size(), 2U);
    EXPECT_EQ(foliation.punctures[0].vertex, a);
    EXPECT_EQ(foliation.punctures[1].vertex, b);
    EXPECT_EQ(foliation.punctures[1].radius, 0.1);
}

TEST(Choice, IsTheSameEveryTime) {
    const Mesh mesh = to_mesh(testing::make_finger(40, 1.5));
    const Foliation a = compute_foliation(mesh);
    Context threads;
    threads.threads = 3;
    const Foliation b = compute_foliation(mesh, {}, threads);
    ASSERT_EQ(a.cylinders.size(), b.cylinders.size());
    ASSERT_EQ(a.punctures.size(), b.punctures.size());
    for (std::size_t k = 0; k < a.cylinders.size(); ++k) {
        EXPECT_EQ(a.cylinders[k].corner_gf, b.cylinders[k].corner_gf);
    }
}

// Real models, if they are there.
Mesh load(const std::string& name) {
#ifdef LEAFCUTTER_SHARED_DIR
    const std::filesystem::path path =
        std::filesystem::path(LEAFCUTTER_SHARED_DIR) / "data/meshes" / name;
    if (std::filesystem::exists(path)) {
        std::ifstream file(path, std::ios::binary);
        const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
        return repair(read_mesh(std::as_bytes(std::span(bytes)), name)).mesh;
    }
#endif
    return {};
}

struct Model {
    const char* file;
    std::size_t least_holes;
    std::size_t most_holes;
    double largest;  // Edge of the largest cells, in mean edges, at most.
};

class ChoiceOfModel : public ::testing::TestWithParam<Model> {};

TEST_P(ChoiceOfModel, NoLimbIsSwallowedByAFewCells) {
    const Mesh mesh = load(GetParam().file);
    if (mesh.n_faces() == 0) {
        GTEST_SKIP() << "no shared data";
    }
    const Foliation foliation = compute_foliation(mesh);
    expect_sound(mesh, foliation);
    EXPECT_GE(foliation.punctures.size(), GetParam().least_holes);
    EXPECT_LE(foliation.punctures.size(), GetParam().most_holes);
    EXPECT_LE(foliation.spread.largest, GetParam().largest);
}

INSTANTIATE_TEST_SUITE_P(Models,
                         ChoiceOfModel,
                         ::testing::Values(Model{"hand-open-wrist.obj", 5, 6, 4.0},
                                           Model{"hand-closed.obj", 6, 8, 5.0},
                                           Model{"face-gu.off", 0, 0, 5.0},
                                           Model{"nefertiti.off", 0, 0, 5.0},
                                           Model{"cow.off", 9, 14, 7.0}));

}  // namespace
}  // namespace leafcutter::geometry
