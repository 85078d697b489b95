// Real models, where the shared data are at hand.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/foliation.h"
#include "geometry/io/read_mesh.h"
#include "geometry/repair.h"
#include "tests/geometry/chart_checks.h"

namespace leafcutter::geometry {
namespace {

struct Model {
    const char* file;
    FoliationMode mode;
    double largest_gap = 0.005;
};

void PrintTo(const Model& model, std::ostream* out) {
    *out << model.file;
}

class ModelTest : public ::testing::TestWithParam<Model> {};

TEST_P(ModelTest, HasASoundChart) {
    const std::filesystem::path path =
        std::filesystem::path(LEAFCUTTER_SHARED_DIR) / "data" / "meshes" / GetParam().file;
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        GTEST_SKIP() << "no shared data";
    }
    const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
    const RepairedMesh repaired =
        repair(read_mesh(std::as_bytes(std::span(bytes)), GetParam().file));
    FoliationOptions options;
    options.puncture = PunctureChoice::None;
    const Foliation foliation = compute_foliation(repaired.mesh, options);
    EXPECT_EQ(foliation.mode, GetParam().mode);
    ASSERT_EQ(foliation.cylinders.size(), 1U);
    const Cylinder& chart = foliation.cylinders[0];
    EXPECT_TRUE(testing::is_sound(chart));
    EXPECT_LT(chart.conformal_gap, GetParam().largest_gap);
    // No vertex of the model is lost.
    const std::set<int> sources(chart.source_vertex.begin(), chart.source_vertex.end());
    EXPECT_EQ(sources.size() - sources.count(-1), repaired.mesh.n_vertices());
}

INSTANTIATE_TEST_SUITE_P(Shared,
                         ModelTest,
                         ::testing::Values(Model{"face-gu.off", FoliationMode::Disk},
                                           Model{"nefertiti.off", FoliationMode::Disk},
                                           Model{"camelhead.off", FoliationMode::Disk},
                                           Model{"demosthenes.obj", FoliationMode::Disk},
                                           Model{"saddle.off", FoliationMode::Disk},
                                           Model{"flat-square.off", FoliationMode::Disk, 1e-9},
                                           Model{"hand-open-wrist.obj", FoliationMode::Disk},
                                           Model{"cylinder.off", FoliationMode::Annulus, 1e-9},
                                           Model{"girl-face-slit.obj", FoliationMode::Annulus,
                                                 0.03},
                                           Model{"torus.off", FoliationMode::Torus},
                                           Model{"knot.obj", FoliationMode::Torus},
                                           Model{"rocker-arm.obj", FoliationMode::Torus},
                                           Model{"kitten-106k.obj", FoliationMode::Torus}),
                         [](const auto& tested) {
                             std::string name = tested.param.file;
                             name.resize(name.find('.'));
                             std::erase(name, '-');
                             return name;
                         });

}  // namespace
}  // namespace leafcutter::geometry
