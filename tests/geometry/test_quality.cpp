#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "geometry/quads/quality.h"
#include "tests/geometry/charts.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

QuadMesh single_quad(const std::array<Vector3d, 4>& corners, double region) {
    QuadMesh mesh;
    mesh.vertices.assign(corners.begin(), corners.end());
    mesh.quads = {{0, 1, 2, 3}};
    mesh.addresses = {{}};
    mesh.grids.resize(1);
    mesh.surface_area = {region};
    return mesh;
}

ClosestPoint plane(double half_size) {
    TriangleMesh mesh{.positions = {{-half_size, -half_size, 0},
                                    {half_size, -half_size, 0},
                                    {half_size, half_size, 0},
                                    {-half_size, half_size, 0}},
                      .triangles = {{0, 1, 2}, {0, 2, 3}}};
    return ClosestPoint(mesh);
}

QualityReport measured(const Foliation& foliation, const GridOptions& options) {
    return measure_quality(build_quad_mesh(foliation, options),
                           ClosestPoint(foliation.cylinders[0].mesh));
}

TEST(Quality, OfAFlatGridIsPerfect) {
    GridOptions options;
    options.strip_width_mm = 10.0;
    const QualityReport report = measured(testing::flat_rectangle(200.0, 300.0), options);
    EXPECT_EQ(report.overall.quads, 600);
    EXPECT_LT(report.overall.angle_deviation_deg.max, 1e-6);
    EXPECT_LT(report.overall.crossing_angle_deviation_deg.max, 1e-6);
    EXPECT_LT(report.overall.angle_deviation_bound_deg, 1e-6);
    EXPECT_LT(report.overall.surface_distance_percent.max, 1e-9);
    EXPECT_LT(report.overall.area_distortion_percent, 1e-9);
    EXPECT_LT(report.overall.planarity_percent.max, 1e-9);
    EXPECT_LT(report.overall.cell_area_variation, 1e-6);
    EXPECT_NEAR(report.overall.largest_cell_edge, 1.0, 1e-9);
    EXPECT_EQ(report.removed_area_percent, 0.0);
}

TEST(Quality, OfARoundCylinderFollowsTheChordFormulas) {
    // 12 chords: the sag is r (1 - cos 15°). Corners stay square, leaves straight in the surface.
    GridOptions options;
    options.all = {.rows = 4, .cols = 12};
    options.half_sag_offset = false;
    const QualityReport report = measured(testing::round_cylinder(10.0, 20.0, 4800, 2), options);
    const double chord = 2.0 * 10.0 * std::sin(kPi / 12.0);
    const double sag = 10.0 * (1.0 - std::cos(kPi / 12.0));
    const double leaves = 0.5 * (12.0 * chord + 20.0);
    EXPECT_NEAR(report.overall.angle_deviation_deg.max, 0.0, 1e-6);
    EXPECT_NEAR(report.overall.angle_deviation_bound_deg, 0.0, 1e-6);
    EXPECT_NEAR(report.overall.surface_distance_percent.max, 100.0 * sag / leaves, 1e-4);
    const double arc = 10.0 * kPi / 6.0;
    EXPECT_NEAR(report.overall.area_distortion_percent, 100.0 * (arc - chord) / arc, 0.05);
}

TEST(Quality, AveragesCornersPerVertexBeforeTheMean) {
    // A rhombus of 60 and 120 degrees: every vertex is 30 degrees off.
    const double h = 0.5 * std::sqrt(3.0);
    const QuadMesh mesh = single_quad(
        {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(1.5, h, 0), Vector3d(0.5, h, 0)}, h);
    const QualityReport report = measure_quality(mesh, plane(10.0));
    EXPECT_NEAR(report.overall.angle_deviation_deg.max, 30.0, 1e-9);
    EXPECT_NEAR(report.overall.angle_deviation_deg.avg, 30.0, 1e-9);
    EXPECT_NEAR(report.overall.area_distortion_percent, 0.0, 1e-9);
}

TEST(Quality, MeasuresTheTwistOfAQuad) {
    // Diagonals at heights +e and -e: their distance is 2 e, their length sqrt 2.
    const double e = 0.05;
    const QuadMesh mesh = single_quad(
        {Vector3d(0, 0, e), Vector3d(1, 0, -e), Vector3d(1, 1, e), Vector3d(0, 1, -e)}, 1.0);
    const QualityReport report = measure_quality(mesh, plane(10.0));
    EXPECT_NEAR(report.overall.planarity_percent.max, 100.0 * 2.0 * e / std::sqrt(2.0), 1e-9);
    // The patch is farthest from the plane at its corners. Each leaf is one edge long.
    const double edge = std::sqrt(1.0 + 4.0 * e * e);
    EXPECT_NEAR(report.overall.surface_distance_percent.max, 100.0 * e / edge, 1e-9);
}

TEST(Quality, CountsTheLimbBehindACapAsRemoved) {
    const std::array<Vector3d, 4> unit{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(1, 1, 0),
                                       Vector3d(0, 1, 0)};
    const ClosestPoint surface = plane(5.0);  // 100 mm² in all.
    EXPECT_NEAR(measure_quality(single_quad(unit, 7.0), surface).removed_area_percent, 6.0, 1e-9);
    EXPECT_EQ(measure_quality(single_quad(unit, 1.09), surface).removed_area_percent, 0.0);
}

TEST(Quality, GivesTheSameFiguresOnAnyNumberOfThreads) {
    const Foliation torus = testing::round_torus(100.0, 25.0);
    const QuadMesh mesh = build_quad_mesh(torus);
    const ClosestPoint surface(torus.cylinders[0].mesh);
    Context threaded;
    threaded.threads = 4;
    const QualityReport one = measure_quality(mesh, surface);
    const QualityReport four = measure_quality(mesh, surface, threaded);
    EXPECT_EQ(one.overall.surface_distance_percent.avg, four.overall.surface_distance_percent.avg);
    EXPECT_EQ(one.overall.surface_distance_percent.max, four.overall.surface_distance_percent.max);
    EXPECT_EQ(one.overall.area_distortion_percent, four.overall.area_distortion_percent);
}

TEST(Quality, ImprovesByTheHalfSagOffset) {
    const Foliation torus = testing::round_torus(100.0, 25.0, 192, 512);
    GridOptions on;
    GridOptions off;
    off.half_sag_offset = false;
    const Quality with = measured(torus, on).overall;
    const Quality without = measured(torus, off).overall;
    EXPECT_LT(with.surface_distance_percent.avg, 0.75 * without.surface_distance_percent.avg);
    EXPECT_LT(with.area_distortion_percent, 0.5 * without.area_distortion_percent);
    EXPECT_NEAR(with.angle_deviation_deg.avg, without.angle_deviation_deg.avg, 0.05);
}

TEST(Quality, OfTheRoundTorusLiesOnItsBound) {
    GridOptions options;
    options.strip_width_mm = 4.0;
    const Quality quality = measured(testing::round_torus(100.0, 25.0, 192, 512), options).overall;
    EXPECT_GE(quality.angle_deviation_deg.avg, quality.angle_deviation_bound_deg - 1e-9);
    EXPECT_LT(quality.crossing_angle_deviation_deg.avg, 0.05);
}

TEST(Quality, BoundsTheAngleDeviationByTheTurningOfTheLeaves) {
    // Rings 30 degrees apart in a flat annulus: a ring turns by 30 degrees at each vertex.
    const Foliation disk = testing::one_cylinder(
        testing::make_chart({.shape = ChartShape::Annulus,
                             .across = 12,
                             .along = 2,
                             .width = 2.0 * kPi,
                             .height = 2.0,
                             .position = [](double u, double v) {
                                 const double radius = std::exp(2.0 - 2.0 * v);
                                 return Vector3d(radius * std::cos(2.0 * kPi * u),
                                                 radius * std::sin(2.0 * kPi * u), 0.0);
                             }}));
    GridOptions options;
    options.all = {.rows = 2, .cols = 12};
    const Quality quality = measured(disk, options).overall;
    EXPECT_NEAR(quality.angle_deviation_bound_deg, 15.0, 1e-9);
    EXPECT_GE(quality.angle_deviation_deg.avg, 15.0 - 1e-9);
    EXPECT_NEAR(quality.crossing_angle_deviation_deg.max, 0.0, 1e-6);
}

TEST(Quality, IsGivenPerCylinder) {
    Foliation two = testing::flat_rectangle(100.0, 100.0);
    two.cylinders.push_back(testing::round_cylinder(20.0, 50.0).cylinders[0]);
    GridOptions options;
    options.junctions = Junctions::Independent;
    const QuadMesh mesh = build_quad_mesh(two, options);
    TriangleMesh both = two.cylinders[0].mesh;
    const int base = static_cast<int>(both.positions.size());
    const TriangleMesh& second = two.cylinders[1].mesh;
    both.positions.insert(both.positions.end(), second.positions.begin(), second.positions.end());
    for (const auto& t : second.triangles) {
        both.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    }
    const QualityReport report = measure_quality(mesh, ClosestPoint(both));
    ASSERT_EQ(report.per_cylinder.size(), 2U);
    EXPECT_EQ(report.per_cylinder[0].quads + report.per_cylinder[1].quads, report.overall.quads);
    EXPECT_LT(report.per_cylinder[0].surface_distance_percent.max, 1e-9);
    EXPECT_GT(report.per_cylinder[1].surface_distance_percent.max, 0.01);
}

}  // namespace
}  // namespace leafcutter::geometry
