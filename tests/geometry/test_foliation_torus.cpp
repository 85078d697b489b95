#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "geometry/foliation.h"
#include "tests/geometry/chart_checks.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;
using testing::is_sound;
using testing::jitter;
using testing::make_grid;
using testing::make_torus;
using testing::to_mesh;
using testing::vertex_gf;

constexpr double kTube = 0.25;

// Circumference over length of a round torus of radii 1 and r, conformally: r / sqrt(1 - r^2).
const double kExact = kTube / std::sqrt(1.0 - kTube * kTube);

Cylinder torus_chart(const TriangleMesh& mesh, TorusRings rings = TorusRings::Short) {
    FoliationOptions options;
    options.torus_rings = rings;
    options.refinement = Refinement::Off;
    options.puncture = PunctureChoice::None;
    return compute_foliation(to_mesh(mesh), options).cylinders[0];
}

TEST(TorusFoliation, ModulusConvergesToTheClosedFormAtSecondOrder) {
    std::vector<double> errors;
    for (const int across : {8, 16, 32}) {
        const Cylinder chart = torus_chart(make_torus(across, 4 * across, kTube));
        EXPECT_TRUE(is_sound(chart));
        errors.push_back(std::abs(chart.width / chart.height - kExact) / kExact);
        EXPECT_NEAR(chart.shear, 0.0, 1e-9);
    }
    EXPECT_LT(errors[2], 5e-3);
    EXPECT_GT(errors[0] / errors[1], 3.5);
    EXPECT_GT(errors[1] / errors[2], 3.5);
}

TEST(TorusFoliation, RiemannsBilinearRelationHoldsAtSecondOrder) {
    const double coarse = torus_chart(make_torus(10, 40, kTube)).conformal_gap;
    const double fine = torus_chart(make_torus(20, 80, kTube)).conformal_gap;
    EXPECT_GT(coarse, 0.0);
    EXPECT_GT(fine, 0.0);
    EXPECT_GT(coarse / fine, 3.5);
}

// requirements T8: the leaves are meridians; the other generator can be chosen too.
TEST(TorusFoliation, ShortRingsAreMeridiansAndLongRingsParallels) {
    const int across = 16;
    const int along = 48;
    const TriangleMesh mesh = make_torus(across, along, kTube);
    const Cylinder short_rings = torus_chart(mesh, TorusRings::Short);
    const Cylinder long_rings = torus_chart(mesh, TorusRings::Long);
    EXPECT_TRUE(is_sound(long_rings));
    EXPECT_NEAR(short_rings.width * long_rings.width, 1.0, 0.02);
    const auto by_short = vertex_gf(short_rings);
    const auto by_long = vertex_gf(long_rings);
    for (int v = 0; v < across * along; ++v) {
        const int meridian = v - v % across;  // The first vertex of the same ring round the tube.
        EXPECT_NEAR(std::remainder(by_short[at(v)].y() - by_short[at(meridian)].y(), 1.0), 0.0,
                    1e-6);
        EXPECT_NEAR(std::remainder(by_long[at(v)].y() - by_long[at(v % across)].y(), 1.0), 0.0,
                    1e-6);
    }
}

// The grid's own loops wind twice round the tube on their way along it.
TEST(TorusFoliation, FindsTheShortBasisOfATwistedMesh) {
    const Cylinder straight = torus_chart(make_torus(32, 256, kTube));
    const TriangleMesh twisted = make_grid(
        {.across = 32,
         .along = 256,
         .closed_across = true,
         .closed_along = true,
         .position = [](double u, double v) {
             const double a = 2.0 * std::numbers::pi * (u + 2.0 * v);
             const double b = -2.0 * std::numbers::pi * v;
             const double r = 1.0 + kTube * std::cos(a);
             return Eigen::Vector3d(r * std::cos(b), r * std::sin(b), kTube * std::sin(a));
         }});
    const Cylinder chart = torus_chart(twisted);
    EXPECT_TRUE(is_sound(chart));
    EXPECT_NEAR(chart.width, straight.width, 0.01 * straight.width);
    EXPECT_LE(std::abs(chart.shear), 0.5 * chart.width);
    EXPECT_NEAR(chart.shear, 0.0, 0.03 * chart.width);
}

TEST(TorusFoliation, KeepsItsPromisesOnRoughTori) {
    for (unsigned seed = 1; seed <= 12; ++seed) {
        std::minstd_rand random(seed);
        TriangleMesh mesh = make_torus(10, 30, 0.35);
        jitter(mesh, 0.05, random);
        testing::add_needles(mesh, 40, random);
        for (const TorusRings rings : {TorusRings::Short, TorusRings::Long}) {
            EXPECT_TRUE(is_sound(torus_chart(mesh, rings))) << "seed " << seed;
            const FoliationOptions refining{.torus_rings = rings, .puncture = PunctureChoice::None};
            EXPECT_TRUE(is_sound(compute_foliation(to_mesh(mesh), refining).cylinders[0]))
                << "seed " << seed;
        }
    }
}

}  // namespace
}  // namespace leafcutter::geometry
