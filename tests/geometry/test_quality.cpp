#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "geometry/quads/quality.h"
#include "geometry/quads/two_sided.h"
#include "tests/geometry/brute_quality.h"
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

TriangleMesh plane_mesh(double half_size) {
    return {.positions = {{-half_size, -half_size, 0},
                          {half_size, -half_size, 0},
                          {half_size, half_size, 0},
                          {-half_size, half_size, 0}},
            .triangles = {{0, 1, 2}, {0, 2, 3}}};
}

ClosestPoint plane(double half_size) {
    return ClosestPoint(plane_mesh(half_size));
}

// A chart of z = height(x, y) over the square of half side `half`.
Foliation sheet(double half, int cells, double (*height)(double, double)) {
    return testing::one_cylinder(
        testing::make_chart({.across = cells,
                             .along = cells,
                             .width = 2.0 * half,
                             .height = 2.0 * half,
                             .position = [half, height](double u, double v) {
                                 const double x = half * (2.0 * u - 1.0);
                                 const double y = half * (2.0 * v - 1.0);
                                 return Vector3d(x, y, height(x, y));
                             }}));
}

QuadMesh grid_on(const Foliation& foliation, int rows, int cols) {
    GridOptions options;
    options.all = {.rows = rows, .cols = cols};
    options.half_sag_offset = false;
    return build_quad_mesh(foliation, options);
}

// Quads of the plane, each a cylinder of its own.
QuadMesh flat_quads(std::vector<Vector3d> vertices, std::vector<std::array<int, 4>> quads) {
    QuadMesh mesh;
    mesh.vertices = std::move(vertices);
    mesh.quads = std::move(quads);
    for (int i = 0; i < static_cast<int>(mesh.quads.size()); ++i) {
        mesh.addresses.push_back({.cylinder = i});
    }
    mesh.grids.resize(mesh.quads.size());
    mesh.surface_area.assign(mesh.quads.size(), 1.0);
    return mesh;
}

// Two columns that turn by `turning_deg` where they go from one cylinder into the next.
QuadMesh bent_columns(double turning_deg) {
    const double turning = turning_deg * kPi / 180.0;
    const Vector3d up(std::sin(turning), std::cos(turning), 0.0);
    std::vector<Vector3d> vertices;
    for (const Vector3d& level : {Vector3d(0, -1, 0), Vector3d(0, 0, 0), up}) {
        for (const double x : {-1.0, 0.0, 1.0}) {
            vertices.emplace_back(level + Vector3d(x, 0, 0));
        }
    }
    QuadMesh mesh = flat_quads(vertices, {{0, 1, 4, 3}, {1, 2, 5, 4}, {3, 4, 7, 6}, {4, 5, 8, 7}});
    mesh.addresses = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 0, 1}};
    mesh.grids.resize(2);
    return mesh;
}

// k equal rhombi around a point of the plane, where k / 2 prongs meet.
QuadMesh star(int k) {
    std::vector<Vector3d> vertices{Vector3d::Zero()};
    std::vector<std::array<int, 4>> quads;
    const auto ray = [k](int i) {
        const double angle = 2.0 * kPi * i / k;
        return Vector3d(std::cos(angle), std::sin(angle), 0.0);
    };
    for (int i = 0; i < k; ++i) {
        vertices.push_back(ray(i));
    }
    for (int i = 0; i < k; ++i) {
        vertices.emplace_back(ray(i) + ray(i + 1));
        const int here = 1 + i;
        const int next = 1 + (i + 1) % k;
        // Leaves of both families by turns: every other quad begins its letters elsewhere.
        quads.push_back(i % 2 == 0 ? std::array{0, here, 1 + k + i, next}
                                   : std::array{next, 0, here, 1 + k + i});
    }
    return flat_quads(vertices, quads);
}

// Where a quad runs inside an edge of the surface, its samples have two closest points: then areas
// agree to `area_tolerance` only.
void expect_as_brute(const QuadMesh& mesh,
                     const TriangleMesh& surface,
                     double area_tolerance = 1e-5) {
    const QualityReport report = measure_quality(mesh, ClosestPoint(surface));
    const testing::BruteQuality brute = testing::brute_quality(mesh, surface);
    const auto expect = [](const MaxAvg& found, const std::vector<double>& values) {
        EXPECT_NEAR(found.max, testing::max_of(values), 1e-6 * (1.0 + testing::max_of(values)));
        EXPECT_NEAR(found.avg, testing::mean_of(values), 1e-6 * (1.0 + testing::mean_of(values)));
    };
    const Quality& overall = report.overall;
    expect(overall.angle_deviation_deg, brute.angle_deviation_deg);
    expect(overall.crossing_angle_deviation_deg, brute.crossing_angle_deviation_deg);
    expect(overall.surface_distance_percent, brute.distance_percent);
    expect(overall.planarity_percent, brute.planarity_percent);
    EXPECT_NEAR(overall.area_distortion_percent, testing::mean_of(brute.area_percent),
                area_tolerance);
    for (std::size_t q = 0; q < report.cells.size(); ++q) {
        EXPECT_NEAR(report.cells[q].distance, brute.distance[q], 1e-9);
        EXPECT_NEAR(report.cells[q].area_percent, brute.area_percent[q], area_tolerance);
    }
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

TEST(Quality, IsWhatTheDefinitionsSayWordByWord) {
    const Foliation saddle =
        sheet(10.0, 12, [](double x, double y) { return 0.05 * (x * x - y * y) + 0.03 * x * y; });
    expect_as_brute(grid_on(saddle, 4, 5), saddle.cylinders[0].mesh);
    const Foliation dome = sheet(
        4.0, 12, [](double x, double y) { return std::sqrt(100.0 - x * x - y * y) + 0.1 * x; });
    expect_as_brute(grid_on(dome, 3, 6), dome.cylinders[0].mesh);
    const Foliation tube = testing::round_cylinder(10.0, 20.0, 24, 6);
    expect_as_brute(grid_on(tube, 3, 10), tube.cylinders[0].mesh, 5e-3);
}

TEST(Quality, OfASphereIsTheSagUnderAChord) {
    // One square cell on top of a sphere of radius 10, corners at half side 1: planar, and farthest
    // from the sphere at its middle.
    const Foliation dome =
        sheet(1.0, 200, [](double x, double y) { return std::sqrt(100.0 - x * x - y * y); });
    const QuadMesh mesh = grid_on(dome, 1, 1);
    const QualityReport report = measure_quality(mesh, ClosestPoint(dome.cylinders[0].mesh));
    const double sag = 10.0 - std::sqrt(100.0 - 2.0);
    EXPECT_NEAR(report.cells[0].distance, sag, 1e-4 * sag);
    EXPECT_NEAR(report.overall.surface_distance_percent.max, 100.0 * sag / 2.0, 1e-3);
    EXPECT_NEAR(report.overall.planarity_percent.max, 0.0, 1e-9);
    // Its corners are the four of a disk.
    EXPECT_NEAR(report.overall.angle_deviation_corner_deg.max, 0.0, 1e-6);
    EXPECT_EQ(report.overall.angle_deviation_interior_deg.max, 0.0);
}

TEST(Quality, OfASaddleIsThatOfItsBilinearCells) {
    // z = k x y is bilinear over squares: no distance, and a known twist.
    const Foliation saddle = sheet(6.0, 240, [](double x, double y) { return 0.1 * x * y; });
    const ClosestPoint surface(saddle.cylinders[0].mesh);
    const Quality one = measure_quality(grid_on(saddle, 1, 1), surface).overall;
    EXPECT_LT(one.surface_distance_percent.max, 2e-3);
    EXPECT_LT(measure_quality(grid_on(saddle, 3, 3), surface).overall.surface_distance_percent.max,
              2e-3);
    // Corners (±6, ±6, ±3.6): diagonals 7.2 apart, 12 sqrt(2) long.
    EXPECT_NEAR(one.planarity_percent.max, 100.0 * 7.2 / (12.0 * std::sqrt(2.0)), 1e-6);
}

TEST(Quality, SeparatesCornersFromEdgesAndInside) {
    QuadMesh mesh = grid_on(testing::flat_rectangle(30.0, 30.0), 3, 3);
    for (Vector3d& vertex : mesh.vertices) {
        if (vertex.norm() < 1e-9) {
            vertex = Vector3d(-4.0, -4.0, 0.0);
        }
    }
    const Quality quality = measure_quality(mesh, plane(40.0)).overall;
    const double at_corner = 90.0 - 2.0 * std::atan(4.0 / 14.0) * 180.0 / kPi;
    EXPECT_NEAR(quality.angle_deviation_corner_deg.max, 90.0 - at_corner, 1e-9);
    EXPECT_NEAR(quality.angle_deviation_corner_deg.avg, 0.25 * (90.0 - at_corner), 1e-9);
    // Its two neighbours on the edge: one corner of two is off.
    EXPECT_NEAR(quality.angle_deviation_boundary_deg.max, 0.5 * std::atan(4.0 / 14.0) * 180.0 / kPi,
                1e-9);
    EXPECT_NEAR(quality.angle_deviation_interior_deg.max, 0.0, 1e-9);
    EXPECT_NEAR(quality.angle_deviation_deg.max, 90.0 - at_corner, 1e-9);
}

TEST(Quality, LetsLeavesGoOnAcrossJunctions) {
    QuadMesh mesh = bent_columns(40.0);
    const QualityReport report = measure_quality(mesh, plane(10.0));
    EXPECT_NEAR(report.overall.angle_deviation_bound_deg, 20.0, 1e-9);
    EXPECT_NEAR(report.overall.angle_deviation_interior_deg.avg, 20.0, 1e-9);
    for (const Quality& cylinder : report.per_cylinder) {
        EXPECT_EQ(cylinder.angle_deviation_interior_deg.max, 0.0);
        EXPECT_EQ(cylinder.angle_deviation_bound_deg, 0.0);
    }
    // The next cylinder may count its rows and columns the other way.
    for (std::size_t i = 2; i < 4; ++i) {
        const auto [a, b, c, d] = mesh.quads[i];
        mesh.quads[i] = {c, d, a, b};
    }
    const QualityReport turned = measure_quality(mesh, plane(10.0));
    EXPECT_EQ(turned.overall.angle_deviation_bound_deg, report.overall.angle_deviation_bound_deg);
    EXPECT_EQ(turned.overall.crossing_angle_deviation_deg.avg,
              report.overall.crossing_angle_deviation_deg.avg);
}

TEST(Quality, BoundsSingularPointsByTheirShareOfAFullTurn) {
    for (const auto& [k, bound] : {std::pair{6, 30.0}, std::pair{8, 45.0}, std::pair{3, 30.0}}) {
        const Quality quality = measure_quality(star(k), plane(10.0)).overall;
        EXPECT_NEAR(quality.angle_deviation_bound_deg, bound, 1e-9);
        EXPECT_NEAR(quality.angle_deviation_singular_deg.max, bound, 1e-9);
        EXPECT_EQ(quality.crossing_angle_deviation_deg.max, 0.0);
    }
}

TEST(Quality, NeverFallsBelowItsBound) {
    const Foliation torus = testing::round_torus(100.0, 40.0);
    const QualityReport report =
        measure_quality(build_quad_mesh(torus), ClosestPoint(torus.cylinders[0].mesh));
    std::size_t bounded = 0;
    for (const VertexQuality& vertex : report.vertices) {
        if (vertex.bound_deg) {
            ++bounded;
            EXPECT_GE(vertex.angle_deviation_deg, *vertex.bound_deg - 1e-9);
        }
    }
    EXPECT_EQ(bounded, report.vertices.size());
}

TEST(TwoSided, OfARoundCylinderIsItsSagBothWays) {
    const Foliation tube = testing::round_cylinder(10.0, 20.0, 2400, 2);
    const QuadMesh mesh = grid_on(tube, 4, 12);
    const TriangleMesh& surface = tube.cylinders[0].mesh;
    const TwoSidedDistance distance =
        measure_two_sided(mesh, measure_quality(mesh, ClosestPoint(surface)).cells, surface);
    const double whole = std::sqrt(20.0 * 20.0 * 3.0);
    const double half = kPi / 12.0;
    const double chord = 10.0 * std::cos(half);  // Distance of a chord from the axis.
    EXPECT_NEAR(distance.both.max, 100.0 * (10.0 - chord) / whole, 2e-3);
    EXPECT_NEAR(distance.surface_to_quads.max, distance.quads_to_surface.max, 2e-3);
    // The mean over an arc of 10 cos(t) − chord.
    EXPECT_NEAR(distance.surface_to_quads.avg,
                100.0 * (10.0 * std::sin(half) / half - chord) / whole, 5e-3);
    EXPECT_NEAR(distance.both.avg,
                0.5 * (distance.surface_to_quads.avg + distance.quads_to_surface.avg), 1e-12);
}

TEST(TwoSided, SeesTheSurfaceThatQuadsLeaveOut) {
    const QuadMesh mesh = single_quad(
        {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(1, 1, 0), Vector3d(0, 1, 0)}, 1.0);
    const TriangleMesh surface = plane_mesh(5.0);
    const TwoSidedDistance distance =
        measure_two_sided(mesh, measure_quality(mesh, ClosestPoint(surface)).cells, surface);
    EXPECT_NEAR(distance.quads_to_surface.max, 0.0, 1e-12);
    EXPECT_NEAR(distance.surface_to_quads.max, 50.0, 1e-9);  // From a corner of the plane.
    EXPECT_EQ(distance.both.max, distance.surface_to_quads.max);
}

TEST(TwoSided, MeasuresToTheBilinearPatch) {
    // A strongly twisted quad against a fine grid of points on it.
    const std::array<Vector3d, 4> corners{Vector3d(0, 0, 0.4), Vector3d(1, 0, -0.4),
                                          Vector3d(1, 1, 0.4), Vector3d(0, 1, -0.4)};
    const QuadMesh mesh = single_quad(corners, 1.0);
    constexpr int kGrid = 200;
    std::vector<Vector3d> on_patch;
    for (int i = 0; i <= kGrid; ++i) {
        for (int j = 0; j <= kGrid; ++j) {
            const double u = double(i) / kGrid;
            const double v = double(j) / kGrid;
            on_patch.emplace_back(u, v, 0.4 * (1.0 - 2.0 * u) * (1.0 - 2.0 * v));
        }
    }
    for (const Vector3d& point : {Vector3d(0.5, 0.5, 0.3), Vector3d(0.2, 0.7, 0.1),
                                  Vector3d(1.4, 0.4, 0.0), Vector3d(-0.3, -0.2, 0.9)}) {
        double nearest = 1e9;
        for (const Vector3d& sample : on_patch) {
            nearest = std::min(nearest, (sample - point).norm());
        }
        const TriangleMesh dot{
            .positions = {point, point + Vector3d(1e-7, 0, 0), point + Vector3d(0, 1e-7, 0)},
            .triangles = {{0, 1, 2}}};
        const double whole = std::sqrt(2.0) * 1e-7;
        const CellQuality flat{.distance = 0.0, .area = 1.0};
        const double found =
            0.01 * whole * measure_two_sided(mesh, {flat}, dot).surface_to_quads.max;
        EXPECT_NEAR(found, nearest, 1e-4);
    }
}

TEST(TwoSided, GivesTheSameFiguresOnAnyNumberOfThreads) {
    const Foliation torus = testing::round_torus(100.0, 25.0);
    const QuadMesh mesh = build_quad_mesh(torus);
    const TriangleMesh& surface = torus.cylinders[0].mesh;
    const std::vector<CellQuality> cells = measure_quality(mesh, ClosestPoint(surface)).cells;
    Context threaded;
    threaded.threads = 4;
    const TwoSidedDistance one = measure_two_sided(mesh, cells, surface);
    const TwoSidedDistance four = measure_two_sided(mesh, cells, surface, threaded);
    EXPECT_EQ(one.both.max, four.both.max);
    EXPECT_EQ(one.both.avg, four.both.avg);
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
    EXPECT_LT(with.area_distortion_percent, 0.55 * without.area_distortion_percent);
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
