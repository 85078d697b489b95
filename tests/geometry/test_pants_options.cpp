// What a user may ask of a foliation by pants: weights, functions, loops; and that it can be
// stopped, and doesn't depend on the number of threads.

#include <algorithm>
#include <cmath>
#include <stop_token>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/foliation.h"
#include "geometry/samples.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::to_mesh;

std::vector<double> weights_of(const Foliation& foliation) {
    std::vector<double> weights;
    for (const MetricGraph::Edge& edge : foliation.graph.edges) {
        weights.push_back(edge.weight);
    }
    return weights;
}

FoliationOptions with_weights(std::vector<double> weights) {
    FoliationOptions options;
    options.function = SweepFunction::Harmonic;
    options.weights = std::move(weights);
    return options;
}

class EightByPants : public ::testing::Test {
protected:
    Mesh mesh = to_mesh(make_sample("eight", 6000));
};

// The gradient of the energy by the weights is the circumferences: 2 E = sum P h, E of degree 2.
TEST_F(EightByPants, HaveCircumferencesThatAreTheEnergysDerivatives) {
    const Foliation even = compute_foliation(mesh, with_weights({1.0, 1.0, 1.0}));
    for (std::size_t e = 0; e < 3; ++e) {
        constexpr double kStep = 0.02;
        std::vector<double> more{1.0, 1.0, 1.0};
        std::vector<double> less = more;
        more[e] += kStep;
        less[e] -= kStep;
        const double slope = (compute_foliation(mesh, with_weights(more)).energy -
                              compute_foliation(mesh, with_weights(less)).energy) /
                             (2.0 * kStep);
        EXPECT_NEAR(slope / even.cylinders[e].width, 1.0, 0.01) << "cylinder " << e;
    }
}

TEST_F(EightByPants, GiveEachCylinderTheHeightOfItsWeight) {
    const std::vector<double> weights{0.7, 1.3, 0.4};
    const Foliation foliation = compute_foliation(mesh, with_weights(weights));
    ASSERT_EQ(foliation.cylinders.size(), 3U);
    for (std::size_t e = 0; e < 3; ++e) {
        EXPECT_NEAR(foliation.cylinders[e].height, weights[e], 1e-12);
    }
}

// Users read the weights off one run, change one and run again: the cylinders must be the same.
TEST_F(EightByPants, KeepTheirNumbersWhenTheirOwnWeightsComeBack) {
    const Foliation automatic = compute_foliation(mesh);
    FoliationOptions options;
    options.weights = weights_of(automatic);
    const Foliation given = compute_foliation(mesh, options);
    ASSERT_EQ(given.cylinders.size(), automatic.cylinders.size());
    EXPECT_NEAR(given.energy / automatic.energy, 1.0, 1e-9);
    for (std::size_t e = 0; e < given.cylinders.size(); ++e) {
        EXPECT_NEAR(given.cylinders[e].width / automatic.cylinders[e].width, 1.0, 1e-6);
    }
}

TEST_F(EightByPants, RefuseTheWrongNumberOfWeights) {
    try {
        compute_foliation(mesh, with_weights({1.0, 1.0}));
        FAIL() << "two weights for three cylinders were taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::BadOption);
        EXPECT_NE(std::string(error.what()).find("3"), std::string::npos);
    }
}

TEST_F(EightByPants, AreTheSameOnAnyNumberOfThreads) {
    Context one;
    Context four;
    four.threads = 4;
    const Foliation a = compute_foliation(mesh, {}, one);
    const Foliation b = compute_foliation(mesh, {}, four);
    EXPECT_EQ(a.energy, b.energy);
    ASSERT_EQ(a.cylinders.size(), b.cylinders.size());
    for (std::size_t e = 0; e < a.cylinders.size(); ++e) {
        EXPECT_EQ(a.cylinders[e].width, b.cylinders[e].width);
        EXPECT_TRUE(a.cylinders[e].corner_gf == b.cylinders[e].corner_gf);
    }
}

TEST_F(EightByPants, StopAtOnceWhenAsked) {
    std::stop_source source;
    Context context;
    context.stop = source.get_token();
    context.progress = [&](std::string_view, double fraction) {
        if (fraction > 0.1) {
            source.request_stop();
        }
    };
    EXPECT_THROW(compute_foliation(mesh, {}, context), Cancelled);
}

// Decompositions differ, what they must have in common doesn't.
TEST_F(EightByPants, PassFromEverySourceOfLoops) {
    for (const PantsSource source :
         {PantsSource::Reeb, PantsSource::HandleLoops, PantsSource::TunnelLoops}) {
        FoliationOptions options;
        options.pants = source;
        const Foliation foliation = compute_foliation(mesh, options);
        EXPECT_EQ(foliation.cylinders.size(), 3U);
        EXPECT_EQ(foliation.singularities.size(), 4U);
        double energy = 0.0;
        for (const Cylinder& cylinder : foliation.cylinders) {
            energy += 0.5 * cylinder.width * cylinder.height;
            EXPECT_LT(cylinder.flux_mismatch, 1e-9);
        }
        EXPECT_NEAR(foliation.energy / energy, 1.0, 0.02);
    }
}

TEST_F(EightByPants, HaveACriticalGraphFromProngToProng) {
    const Foliation foliation = compute_foliation(mesh);
    ASSERT_FALSE(foliation.critical_graph.empty());
    std::size_t ends = 0;
    for (const auto& curve : foliation.critical_graph) {
        for (const Eigen::Vector3d& end : {curve.front(), curve.back()}) {
            ends += static_cast<std::size_t>(std::count_if(
                foliation.singularities.begin(), foliation.singularities.end(),
                [&](const Singularity& s) { return (s.position - end).norm() < 1e-12; }));
        }
    }
    // Each of the four points has three prongs.
    EXPECT_EQ(ends, 12U);
    EXPECT_EQ(foliation.critical_graph.size(), 6U);
}

}  // namespace
}  // namespace leafcutter::geometry
