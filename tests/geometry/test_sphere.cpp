// Closed surfaces of genus 0: the pillowcase against closed forms, its grid and its threads.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/cases/sphere.h"
#include "geometry/cases/sphere_points.h"
#include "geometry/io/read_mesh.h"
#include "geometry/leaves.h"
#include "geometry/quads/quad_edges.h"
#include "geometry/quads/quad_mesh.h"
#include "geometry/quads/threads.h"
#include "geometry/repair.h"
#include "geometry/samples.h"
#include "geometry/topology.h"
#include "tests/geometry/chart_checks.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Vector3d;
using testing::at;

double area_of(const TriangleMesh& mesh) {
    double area = 0.0;
    for (const auto& t : mesh.triangles) {
        const Vector3d& a = mesh.positions[at(t[0])];
        area += 0.5 * (mesh.positions[at(t[1])] - a).cross(mesh.positions[at(t[2])] - a).norm();
    }
    return area;
}

TriangleMesh ellipsoid(const Vector3d& axes, int faces = 4000) {
    TriangleMesh mesh = make_sample("sphere", faces);
    for (Vector3d& p : mesh.positions) {
        p = p.normalized().cwiseProduct(axes);
    }
    return mesh;
}

// The cube [-1, 1]^3 with n x n cells on each side.
TriangleMesh box(int n) {
    TriangleMesh mesh;
    std::map<std::array<int, 3>, int> known;
    const auto vertex = [&](const std::array<int, 3>& p) {
        const auto [found, is_new] = known.try_emplace(p, static_cast<int>(mesh.positions.size()));
        if (is_new) {
            mesh.positions.emplace_back(2.0 * p[0] / n - 1.0, 2.0 * p[1] / n - 1.0,
                                        2.0 * p[2] / n - 1.0);
        }
        return found->second;
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const int side : {0, n}) {
            for (int i = 0; i < n; ++i) {
                for (int j = 0; j < n; ++j) {
                    const auto corner = [&](int u, int v) {
                        std::array<int, 3> p{};
                        p[axis] = side;
                        p[(axis + 1) % 3] = side == 0 ? v : u;
                        p[(axis + 2) % 3] = side == 0 ? u : v;
                        return vertex(p);
                    };
                    mesh.triangles.push_back(
                        {corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)});
                    mesh.triangles.push_back(
                        {corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)});
                }
            }
        }
    }
    return mesh;
}

std::vector<int> vertices_at(const TriangleMesh& mesh, const std::vector<Vector3d>& places) {
    std::vector<int> out;
    for (const Vector3d& place : places) {
        const auto nearest =
            std::min_element(mesh.positions.begin(), mesh.positions.end(),
                             [&](const Vector3d& a, const Vector3d& b) {
                                 return (a - place).squaredNorm() < (b - place).squaredNorm();
                             });
        out.push_back(static_cast<int>(nearest - mesh.positions.begin()));
    }
    return out;
}

const double kThird = 1.0 / std::sqrt(3.0);
const std::vector<Vector3d> kTetrahedron{{kThird, kThird, kThird},
                                         {kThird, -kThird, -kThird},
                                         {-kThird, kThird, -kThird},
                                         {-kThird, -kThird, kThird}};
const std::vector<Vector3d> kEquator{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};

FoliationOptions near(std::vector<int> points, Refinement refinement = Refinement::Allowed) {
    FoliationOptions options;
    options.near = std::move(points);
    options.refinement = refinement;
    return options;
}

// One chart that covers all of the surface, folded at four points.
void expect_pillowcase(const TriangleMesh& mesh, const Foliation& foliation) {
    EXPECT_EQ(foliation.mode, FoliationMode::SpherePillowcase);
    EXPECT_EQ(foliation.graph.nodes, 2);
    ASSERT_EQ(foliation.graph.edges.size(), 1U);
    ASSERT_EQ(foliation.cylinders.size(), 1U);
    const Cylinder& chart = foliation.cylinders[0];
    EXPECT_EQ(chart.shape, ChartShape::Pillowcase);
    EXPECT_TRUE(testing::is_sound(chart));
    EXPECT_NEAR(area_of(chart.mesh) / area_of(mesh), 1.0, 1e-9);
    EXPECT_NEAR(chart.energy, 0.5 * chart.width * std::sqrt(1.0 + chart.conformal_gap),
                1e-9 * chart.width);
    const std::set<int> sources(chart.source_vertex.begin(), chart.source_vertex.end());
    EXPECT_EQ(sources.size() - sources.count(-1), mesh.positions.size());
    ASSERT_EQ(foliation.singularities.size(), 4U);
    for (const Singularity& point : foliation.singularities) {
        EXPECT_EQ(point.prongs, 1);
    }
    ASSERT_EQ(foliation.critical_graph.size(), 2U);
    for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_EQ(foliation.critical_graph[k].front(), foliation.singularities[2 * k].position);
        EXPECT_EQ(foliation.critical_graph[k].back(), foliation.singularities[2 * k + 1].position);
    }
    EXPECT_GT(foliation.spread.variation, 0.0);
    EXPECT_LT(chart.flux_mismatch, 1e-8);
}

// The two sides of a slit meet at mirrored places: (g, 0) and (-g, 0), (g, 1) and (2 shear - g, 1).
void expect_mirrored_folds(const Foliation& foliation) {
    const Cylinder& chart = foliation.cylinders[0];
    const std::vector<Eigen::Vector2d> gf = testing::vertex_gf(chart);
    std::map<std::array<double, 3>, std::vector<Eigen::Vector2d>> at_place;
    for (std::size_t v = 0; v < gf.size(); ++v) {
        if (gf[v].y() == 0.0 || gf[v].y() == 1.0) {
            const Vector3d& p = chart.mesh.positions[v];
            at_place[{std::round(p.x() * 1e9), std::round(p.y() * 1e9), std::round(p.z() * 1e9)}]
                .push_back(gf[v]);
        }
    }
    std::size_t singular = 0;
    for (const auto& [place, images] : at_place) {
        ASSERT_LE(images.size(), 2U);
        singular += images.size() == 1 ? 1 : 0;
        EXPECT_EQ(images.front().y(), images.back().y());
        const double mirror = images.front().y() == 0.0 ? 0.0 : 2.0 * chart.shear;
        const double off = (images.front().x() + images.back().x() - mirror) / chart.width;
        EXPECT_NEAR(off, std::round(off), 1e-9);
    }
    EXPECT_EQ(singular, 4U);
    EXPECT_GT(at_place.size(), 8U);
}

QuadMesh quads_of(const Foliation& foliation,
                  int rows,
                  int cols,
                  Spacing spacing = Spacing::Uniform) {
    GridOptions options;
    options.all = {.rows = rows, .cols = cols};
    options.spacing = spacing;
    return build_quad_mesh(foliation, options);
}

// Closed, four vertices of valence 2 and all others of valence 4, in two colours, every thread
// closed.
void expect_closed_weave(const QuadMesh& mesh) {
    const QuadNeighbours neighbours = find_neighbours(mesh.quads);
    EXPECT_EQ(neighbours.faults, 0);
    EXPECT_EQ(neighbours.boundary_edges, 0);
    const int euler = static_cast<int>(mesh.vertices.size()) - neighbours.edges +
                      static_cast<int>(mesh.quads.size());
    EXPECT_EQ(euler, 2);
    std::vector<int> corners(mesh.vertices.size(), 0);
    for (std::size_t quad = 0; quad < mesh.quads.size(); ++quad) {
        for (std::size_t side = 0; side < 4; ++side) {
            ++corners[at(mesh.quads[quad][side])];
            const auto other = at(neighbours.across[quad][side].quad);
            const QuadAddress& here = mesh.addresses[quad];
            const QuadAddress& there = mesh.addresses[other];
            EXPECT_NE((here.row + here.col) % 2, (there.row + there.col) % 2);
        }
    }
    EXPECT_EQ(std::count(corners.begin(), corners.end(), 2), 4);
    EXPECT_EQ(std::count(corners.begin(), corners.end(), 4),
              static_cast<std::ptrdiff_t>(corners.size()) - 4);
    for (const Family family : {Family::Weft, Family::Warp}) {
        std::size_t cells = 0;
        for (const Thread& thread : trace_threads(mesh, family, ThreadEnds::AtCriticalLeaves)) {
            EXPECT_TRUE(thread.closed);
            cells += thread.quads.size();
        }
        EXPECT_EQ(cells, mesh.quads.size());
    }
}

TEST(Pillowcase, OverATetrahedronIsHalfTheHexagonalTorus) {
    const TriangleMesh mesh = make_sample("sphere", 8000);
    const Foliation foliation = foliate_pillowcase(mesh, near(vertices_at(mesh, kTetrahedron)), {});
    expect_pillowcase(mesh, foliation);
    expect_mirrored_folds(foliation);
    const Cylinder& chart = foliation.cylinders[0];
    EXPECT_NEAR(chart.width, 4.0 / std::sqrt(3.0), 0.04);
    EXPECT_NEAR(std::abs(chart.shear), 0.25 * chart.width, 0.04);
    EXPECT_LT(chart.conformal_gap, 0.005);
}

TEST(Pillowcase, OverASquareOnTheEquatorIsHalfTheSquareTorus) {
    const TriangleMesh mesh = make_sample("sphere", 8000);
    const Foliation foliation = foliate_pillowcase(mesh, near(vertices_at(mesh, kEquator)), {});
    expect_pillowcase(mesh, foliation);
    expect_mirrored_folds(foliation);
    EXPECT_NEAR(foliation.cylinders[0].width, 2.0, 0.02);
    EXPECT_NEAR(foliation.cylinders[0].shear, 0.0, 0.02);
}

TEST(Pillowcase, BoundsOfItsModulusCloseInWhereTheMeshIsFiner) {
    double before = 1.0;
    for (const int faces : {800, 3200, 12800}) {
        const TriangleMesh mesh = make_sample("sphere", faces);
        const Foliation foliation =
            foliate_pillowcase(mesh, near(vertices_at(mesh, kEquator), Refinement::Off), {});
        const double gap = foliation.cylinders[0].conformal_gap;
        EXPECT_GT(gap, 0.0);
        EXPECT_LT(gap, 0.65 * before);
        before = gap;
    }
    EXPECT_LT(before, 0.03);
}

TEST(Pillowcase, CoversABoxFromItsCorners) {
    const TriangleMesh mesh = box(12);
    const Foliation foliation = foliate_pillowcase(
        mesh, near(vertices_at(mesh, {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}})), {});
    expect_pillowcase(mesh, foliation);
    expect_mirrored_folds(foliation);
    expect_closed_weave(quads_of(foliation, 12, 24));
}

TEST(Pillowcase, TakesPointsThatAreNeighbours) {
    const TriangleMesh mesh = ellipsoid({1.0, 1.3, 0.8}, 2000);
    const auto& triangle = mesh.triangles[17];
    std::vector<int> points(triangle.begin(), triangle.end());
    points.push_back(mesh.triangles[1200][0]);
    ASSERT_EQ(std::set<int>(points.begin(), points.end()).size(), 4U);
    const Foliation foliation = foliate_pillowcase(mesh, near(points), {});
    expect_pillowcase(mesh, foliation);
    expect_mirrored_folds(foliation);
}

TEST(Pillowcase, WeavesClosedWhetherTheFoldsAreShiftedOrNot) {
    const TriangleMesh sphere = make_sample("sphere", 4000);
    const Foliation slanted =
        foliate_pillowcase(sphere, near(vertices_at(sphere, kTetrahedron)), {});
    const QuadMesh shifted = quads_of(slanted, 14, 36);
    EXPECT_NE(shifted.grids[0].column_shift, 0);
    EXPECT_LT(std::abs(shifted.grids[0].shear_deg), 2.0);
    expect_closed_weave(shifted);
    const Foliation square = foliate_pillowcase(sphere, near(vertices_at(sphere, kEquator)), {});
    const QuadMesh straight = quads_of(square, 15, 30);
    EXPECT_EQ(straight.grids[0].column_shift, 0);
    expect_closed_weave(straight);
    // Without a shift every warp thread goes up one column and down another.
    for (const Thread& thread : trace_threads(straight, Family::Warp, ThreadEnds::Through)) {
        EXPECT_EQ(thread.quads.size(), 30U);
    }
}

TEST(Pillowcase, WeavesClosedWithGradedLevels) {
    const TriangleMesh mesh = ellipsoid({1.0, 2.0, 0.7});
    const Foliation foliation = foliate_pillowcase(
        mesh,
        near(vertices_at(mesh, {{0.2, 1.9, 0}, {-0.2, 1.9, 0}, {0.6, -1.6, 0}, {-0.6, -1.6, 0}})),
        {});
    for (const Spacing spacing : {Spacing::Uniform, Spacing::Curvature}) {
        expect_closed_weave(quads_of(foliation, 16, 20, spacing));
    }
}

TEST(Pillowcase, NeedsAnEvenNumberOfColumnsAndTwoRows) {
    const TriangleMesh mesh = make_sample("sphere", 2000);
    const Foliation foliation = foliate_pillowcase(mesh, near(vertices_at(mesh, kEquator)), {});
    expect_closed_weave(quads_of(foliation, 2, 4));
    EXPECT_THROW(quads_of(foliation, 8, 9), Error);
    EXPECT_THROW(quads_of(foliation, 1, 8), Error);
    EXPECT_THROW(quads_of(foliation, 8, 2), Error);
    GridOptions odd;
    odd.parity = Parity::Any;
    odd.strip_width_mm = 0.2;
    EXPECT_EQ(build_quad_mesh(foliation, odd).grids[0].cols % 2, 0);
}

TEST(Pillowcase, LeavesCloseOrEndAtSingularPoints) {
    const TriangleMesh mesh = make_sample("sphere", 4000);
    const Foliation foliation = foliate_pillowcase(mesh, near(vertices_at(mesh, kTetrahedron)), {});
    const QuadMesh quads = quads_of(foliation, 12, 24);
    std::size_t arcs = 0;
    std::size_t columns = 0;
    for (const Leaf& leaf : sample_leaves(foliation, quads)) {
        double longest = 0.0;
        for (std::size_t i = 1; i < leaf.points.size(); ++i) {
            longest = std::max(longest, (leaf.points[i] - leaf.points[i - 1]).norm());
        }
        EXPECT_LT(longest, 0.2);  // No jump over the surface.
        columns += leaf.of_conjugate ? 1 : 0;
        if (leaf.closed) {
            EXPECT_LT((leaf.points.front() - leaf.points.back()).norm(), 0.2);
            continue;
        }
        ++arcs;
        for (const Vector3d& end : {leaf.points.front(), leaf.points.back()}) {
            const auto is_there = [&](const Singularity& point) {
                return (point.position - end).norm() < 1e-6;
            };
            EXPECT_TRUE(std::any_of(foliation.singularities.begin(), foliation.singularities.end(),
                                    is_there));
        }
    }
    EXPECT_EQ(arcs, 4U);  // Two of each family.
    EXPECT_GT(columns, 2U);
}

TEST(Pillowcase, RefusesAnythingButFourDifferentVerticesOrLess) {
    const TriangleMesh mesh = make_sample("sphere", 1000);
    for (const std::vector<int>& points : std::vector<std::vector<int>>{
             {3, 3}, {1, 2, 3, 3}, {1, 2, 3, -1}, {1, 2, 3, 1 << 20}, {1, 2, 3, 4, 5}}) {
        try {
            foliate_pillowcase(mesh, near(points), {});
            FAIL() << points.size() << " points taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::BadOption);
            EXPECT_EQ(error.code(), points.size() > 4 ? "too-many-near" : "bad-near");
        }
    }
}

TEST(Pillowcase, FindsPlacesForTheRestOfItsPoints) {
    const TriangleMesh mesh = make_sample("sphere", 1000);
    for (const std::vector<int>& points : std::vector<std::vector<int>>{{17}, {17, 200, 3}}) {
        const Foliation foliation = foliate_pillowcase(mesh, near(points), {});
        expect_pillowcase(mesh, foliation);
        for (const int v : points) {
            EXPECT_TRUE(std::any_of(
                foliation.singularities.begin(), foliation.singularities.end(),
                [&](const Singularity& s) {
                    return (s.position - mesh.positions[static_cast<std::size_t>(v)]).norm() < 1e-9;
                }))
                << v;
        }
    }
}

TEST(Pillowcase, SearchFindsPointsWithEvenCellsWhateverTheThreads) {
    // Two limbs from a ball: points must sit on both.
    TriangleMesh mesh = make_sample("sphere", 6000);
    for (Vector3d& p : mesh.positions) {
        p.normalize();
        p *= 1.0 + 2.0 * std::exp(-8.0 * (1.0 - p.x())) + 2.0 * std::exp(-8.0 * (1.0 - p.y()));
    }
    Context two;
    two.threads = 2;
    const std::array<int, 4> found = choose_pillow_points(mesh, {}, {});
    EXPECT_EQ(found, choose_pillow_points(mesh, {}, two));
    const Foliation chosen = foliate_pillowcase(mesh, {}, {});
    expect_pillowcase(mesh, chosen);
    const Foliation blind = foliate_pillowcase(mesh, near(vertices_at(mesh, kTetrahedron)), {});
    EXPECT_LT(chosen.spread.variation, 0.5 * blind.spread.variation);
}

TEST(Pillowcase, StopsWhenAsked) {
    std::stop_source source;
    source.request_stop();
    Context context;
    context.stop = source.get_token();
    EXPECT_THROW(foliate_pillowcase(make_sample("sphere", 2000), {}, context), Cancelled);
}

TEST(SpherePolar, OfARoundSphereHasLatitudesAndLongitudes) {
    TriangleMesh mesh = box(28);  // It has vertices exactly at the poles.
    for (Vector3d& p : mesh.positions) {
        p.normalize();
    }
    const std::vector<int> ends = vertices_at(mesh, {{0, 0, 1}, {0, 0, -1}});
    FoliationOptions options;
    options.poles = {ends[0], ends[1]};
    const Foliation foliation = foliate_sphere_polar(mesh, options, {});
    EXPECT_EQ(foliation.mode, FoliationMode::SpherePolar);
    ASSERT_EQ(foliation.cylinders.size(), 1U);
    EXPECT_TRUE(foliation.singularities.empty());
    const Cylinder& chart = foliation.cylinders[0];
    EXPECT_TRUE(testing::is_sound(chart));
    ASSERT_EQ(foliation.punctures.size(), 2U);
    const double radius = foliation.punctures[0].radius;
    EXPECT_EQ(foliation.punctures[0].vertex, ends[0]);
    EXPECT_EQ(foliation.punctures[1].vertex, ends[1]);
    EXPECT_NEAR(foliation.punctures[1].radius, radius, 1e-12);
    EXPECT_NEAR(radius / (0.02 * 2.0 * std::sqrt(3.0)), 1.0, 0.05);
    // Mercator: height is the logarithm of the tangent of half the distance from a pole.
    const double height = -2.0 * std::log(std::tan(0.5 * radius));
    EXPECT_NEAR(chart.width / (2.0 * std::numbers::pi / height), 1.0, 0.02);
    const double caps = 2.0 * std::numbers::pi * radius * radius;
    EXPECT_NEAR(area_of(mesh) - area_of(chart.mesh), caps, 0.05 * caps);
    const std::vector<Eigen::Vector2d> gf = testing::vertex_gf(chart);
    for (std::size_t v = 0; v < gf.size(); ++v) {
        const Vector3d p = chart.mesh.positions[v].normalized();
        const double polar = 0.5 * std::acos(std::clamp(p.z(), -1.0, 1.0));
        const double place = 0.5 + std::log(std::tan(polar)) / height;
        EXPECT_NEAR(gf[v].y(), place, 0.02);
        if (chart.source_vertex[v] >= 0) {
            EXPECT_EQ(chart.mesh.positions[v], mesh.positions[at(chart.source_vertex[v])]);
        }
    }
}

TEST(SpherePolar, FindsTheEndsOfALongShape) {
    const TriangleMesh mesh = ellipsoid({0.7, 3.0, 1.0});
    const Foliation foliation = foliate_sphere_polar(mesh, {}, {});
    ASSERT_EQ(foliation.punctures.size(), 2U);
    const double one = mesh.positions[at(foliation.punctures[0].vertex)].y();
    const double other = mesh.positions[at(foliation.punctures[1].vertex)].y();
    EXPECT_GT(std::min(std::abs(one), std::abs(other)), 2.9);
    EXPECT_LT(one * other, 0.0);
    EXPECT_GT(foliation.spread.variation, 0.0);
}

TEST(SpherePolar, RefusesAnythingButTwoDifferentVertices) {
    const TriangleMesh mesh = make_sample("sphere", 1000);
    for (const std::array<int, 2>& poles :
         {std::array<int, 2>{7, 7}, std::array<int, 2>{-1, 7}, std::array<int, 2>{7, 1 << 20}}) {
        FoliationOptions options;
        options.poles = poles;
        try {
            foliate_sphere_polar(mesh, options, {});
            FAIL() << poles[0] << " and " << poles[1] << " taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::BadOption);
            EXPECT_EQ(error.code(), "bad-poles");
        }
    }
}

struct Model {
    const char* file;
    double largest_variation;
};

void PrintTo(const Model& model, std::ostream* out) {
    *out << model.file;
}

class PillowModelTest : public ::testing::TestWithParam<Model> {};

TEST_P(PillowModelTest, IsWovenClosed) {
    const std::filesystem::path path =
        std::filesystem::path(LEAFCUTTER_SHARED_DIR) / "data" / "meshes" / GetParam().file;
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        GTEST_SKIP() << "no shared data";
    }
    const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
    const TriangleMesh mesh =
        to_triangle_mesh(repair(read_mesh(std::as_bytes(std::span(bytes)), GetParam().file)).mesh);
    const Foliation foliation = foliate_pillowcase(mesh, {}, {});
    expect_pillowcase(mesh, foliation);
    expect_mirrored_folds(foliation);
    EXPECT_LT(foliation.spread.variation, GetParam().largest_variation);
    EXPECT_LT(foliation.cylinders[0].conformal_gap, 0.005);
    GridOptions options;
    options.strip_width_mm = std::sqrt(area_of(mesh) / 2000.0);
    expect_closed_weave(build_quad_mesh(foliation, options));
}

INSTANTIATE_TEST_SUITE_P(Shared,
                         PillowModelTest,
                         ::testing::Values(Model{"bunny.off", 1.6}, Model{"spot.obj", 1.9}));

}  // namespace
}  // namespace leafcutter::geometry
