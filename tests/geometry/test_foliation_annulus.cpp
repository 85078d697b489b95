#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "geometry/foliation.h"
#include "tests/geometry/chart_checks.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;
using testing::is_sound;
using testing::make_grid;
using testing::make_prism;
using testing::make_ring;
using testing::renumbered;
using testing::to_mesh;
using testing::vertex_gf;

// Tests of the plain discretisation.
constexpr FoliationOptions kAsGiven{.refinement = Refinement::Off};

TEST(AnnulusFoliation, IsExactOnAPrism) {
    const TriangleMesh prism = make_prism(24, 20, 0.2, 1.0);
    const Foliation foliation = compute_foliation(to_mesh(prism));
    const Cylinder& chart = foliation.cylinders[0];
    EXPECT_TRUE(is_sound(chart));
    const double perimeter = 24.0 * 0.4 * std::sin(std::numbers::pi / 24.0);
    EXPECT_NEAR(chart.width, perimeter, 1e-12);
    EXPECT_NEAR(chart.height, 1.0, 0.0);
    EXPECT_NEAR(chart.conformal_gap, 0.0, 1e-11);
    EXPECT_NEAR(foliation.energy, 0.5 * perimeter, 1e-12);
    for (std::size_t v = 0; v < prism.positions.size(); ++v) {
        const double f = vertex_gf(chart)[v].y();
        const double z = prism.positions[v].z();
        EXPECT_LT(std::min(std::abs(f - z), std::abs(1.0 - f - z)), 1e-12);
    }
}

TEST(AnnulusFoliation, BoundaryLoopsAreLeaves) {
    const TriangleMesh ring = make_ring(40, 12, 0.3, 1.0);
    const Cylinder chart = compute_foliation(to_mesh(ring)).cylinders[0];
    const auto gf = vertex_gf(chart);
    for (std::size_t k = 0; k < 40; ++k) {
        EXPECT_EQ(gf[k].y(), 0.0);  // The longer loop.
        EXPECT_EQ(gf[ring.positions.size() - 1 - k].y(), chart.height);
    }
}

TEST(AnnulusFoliation, ModulusOfAFlatRingConvergesToTheClosedForm) {
    const double exact = 2.0 * std::numbers::pi / std::log(3.0);
    std::vector<double> errors;
    for (const int cells : {6, 12, 24}) {
        const Cylinder chart =
            compute_foliation(to_mesh(make_ring(5 * cells, cells, 1.0, 3.0)), kAsGiven)
                .cylinders[0];
        EXPECT_TRUE(is_sound(chart));
        errors.push_back(std::abs(chart.width / chart.height - exact) / exact);
    }
    EXPECT_LT(errors[2], 1e-3);
    EXPECT_GT(errors[0] / errors[1], 3.5);
    EXPECT_GT(errors[1] / errors[2], 3.5);
}

TEST(AnnulusFoliation, WidthLiesBetweenItsCertifiedBounds) {
    const Foliation foliation = compute_foliation(to_mesh(make_ring(15, 3, 1.0, 3.0)), kAsGiven);
    const double exact = 2.0 * std::numbers::pi / std::log(3.0);
    const double upper = 2.0 * foliation.energy;
    EXPECT_GT(upper, foliation.cylinders[0].width);
    EXPECT_NEAR(upper / foliation.cylinders[0].width,
                std::sqrt(1.0 + foliation.cylinders[0].conformal_gap), 1e-12);
    EXPECT_GT(foliation.cylinders[0].conformal_gap, 0.0);
    EXPECT_NEAR(foliation.cylinders[0].width, exact, 0.05 * exact);
}

// The cut runs elsewhere when vertices and triangles are numbered differently; the map doesn't.
TEST(AnnulusFoliation, DoesNotDependOnTheCut) {
    const TriangleMesh ring = make_grid(
        {.across = 30, .along = 10, .closed_across = true, .position = [](double u, double v) {
             const double a = 2.0 * std::numbers::pi * u;
             const double r = 1.0 + 0.3 * std::cos(3.0 * a) * v;
             return Eigen::Vector3d(r * std::cos(a), r * std::sin(a), 0.8 * v);
         }});
    const Cylinder a = compute_foliation(to_mesh(ring), kAsGiven).cylinders[0];
    const Cylinder b = compute_foliation(to_mesh(renumbered(ring)), kAsGiven).cylinders[0];
    ASSERT_NEAR(a.width, b.width, 1e-9);
    const auto gf_a = vertex_gf(a);
    const auto gf_b = vertex_gf(b);
    const std::size_t last = ring.positions.size() - 1;
    const double shift = gf_b[last].x() - gf_a[0].x();
    for (std::size_t v = 0; v <= last; ++v) {
        const double turns = (gf_b[last - v].x() - gf_a[v].x() - shift) / a.width;
        EXPECT_NEAR(turns, std::round(turns), 1e-9);
        EXPECT_NEAR(gf_b[last - v].y(), gf_a[v].y(), 1e-9);
    }
}

// Section 3.6.1: the annulus and its reversed copy, glued along both loops, are a torus; its
// symmetric map, on the half, is ours. Vertices of the copy: mirror images in the plane z = 0,
// loops shared.
TEST(AnnulusFoliation, IsHalfOfTheFoliationOfTheDoubleCover) {
    const int across = 30;
    const int along = 9;
    const TriangleMesh half =
        make_grid({.across = across,
                   .along = along,
                   .closed_across = true,
                   .position = [](double u, double v) {
                       const double a = 2.0 * std::numbers::pi * u;
                       const double r =
                           3.0 + std::cos(std::numbers::pi * v) + 0.2 * std::cos(2.0 * a) * v;
                       return Eigen::Vector3d(r * std::cos(a), r * std::sin(a),
                                              std::sin(std::numbers::pi * v));
                   }});
    TriangleMesh doubled = half;
    const int loop_end = along * across;  // Vertices below `across` or from here on are on loops.
    std::vector<int> copy_of(half.positions.size());
    for (int v = 0; v < static_cast<int>(half.positions.size()); ++v) {
        const bool shared = v < across || v >= loop_end;
        copy_of[at(v)] = shared ? v : static_cast<int>(doubled.positions.size());
        if (!shared) {
            doubled.positions.emplace_back(
                half.positions[at(v)].cwiseProduct(Eigen::Vector3d(1, 1, -1)));
        }
    }
    for (const auto& t : half.triangles) {
        doubled.triangles.push_back({copy_of[at(t[0])], copy_of[at(t[2])], copy_of[at(t[1])]});
    }
    const Cylinder annulus = compute_foliation(to_mesh(half), kAsGiven).cylinders[0];
    for (const TorusRings rings : {TorusRings::Short, TorusRings::Long}) {
        FoliationOptions options = kAsGiven;
        options.torus_rings = rings;
        const Cylinder torus = compute_foliation(to_mesh(doubled), options).cylinders[0];
        const auto gf = vertex_gf(torus);
        // One of the two families has the loops as leaves: there f is constant on them.
        if (std::abs(std::remainder(gf[0].y() - gf[7].y(), torus.height)) > 1e-6) {
            continue;
        }
        const auto half_gf = vertex_gf(annulus);
        // Twice the height for the same circumference.
        EXPECT_NEAR(torus.width / torus.height, 0.5 * annulus.width / annulus.height, 1e-9);
        EXPECT_NEAR(torus.conformal_gap, annulus.conformal_gap, 1e-9);
        // Starting at the same loop, rising the same way or the other.
        for (std::size_t v = 0; v < half.positions.size(); ++v) {
            const double on_torus =
                std::abs(std::remainder(gf[v].y() - gf[0].y(), torus.height)) / torus.height;
            EXPECT_NEAR(on_torus, 0.5 * std::abs(half_gf[v].y() - half_gf[0].y()), 1e-9);
        }
        return;
    }
    FAIL() << "no family of the torus has the boundary loops as leaves";
}

TEST(AnnulusFoliation, SplitsChordsOfALoop) {
    // Corner triangles glued onto a rim: each has two border edges, its third is a chord.
    TriangleMesh prism = make_prism(12, 4, 1.0, 1.0);
    for (int i = 0; i < 12; i += 2) {
        const Eigen::Vector3d middle =
            0.5 * (prism.positions[at(i)] + prism.positions[at((i + 1) % 12)]);
        prism.positions.emplace_back(middle + Eigen::Vector3d(0, 0, -0.2));
        prism.triangles.push_back({(i + 1) % 12, i, static_cast<int>(prism.positions.size()) - 1});
    }
    const Cylinder chart = compute_foliation(to_mesh(prism), kAsGiven).cylinders[0];
    EXPECT_TRUE(is_sound(chart));
    EXPECT_EQ(chart.mesh.positions.size(), prism.positions.size() + 6);
}

}  // namespace
}  // namespace leafcutter::geometry
