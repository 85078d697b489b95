// Planar quads: what they promise and what they may cost.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <span>
#include <stop_token>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/closest_point.h"
#include "geometry/error.h"
#include "geometry/foliation.h"
#include "geometry/quads/cell_blocks.h"
#include "geometry/quads/planar_cell.h"
#include "geometry/quads/planarise.h"
#include "geometry/quads/quad_edges.h"
#include "geometry/quads/quad_mesh.h"
#include "geometry/quads/quality.h"
#include "geometry/samples.h"
#include "tests/geometry/charts.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;

struct Case {
    Mesh surface;
    Foliation foliation;
    GridOptions options;
};

// The two-holed sample, where leaves are far from lines of curvature.
Case eight(Junctions junctions) {
    Case made;
    made.surface = testing::to_mesh(make_sample("eight", 2000));
    FoliationOptions options;
    options.mode = FoliationMode::Pants;
    options.puncture = PunctureChoice::None;
    made.foliation = compute_foliation(made.surface, options);
    double area = 0.0;
    for (const Cylinder& cylinder : made.foliation.cylinders) {
        area += testing::area_of(cylinder.mesh);
    }
    made.options.strip_width_mm = std::sqrt(area / 300.0);
    made.options.junctions = junctions;
    return made;
}

// A square of a saddle, its leaves along the worst directions there are: the straight lines in it.
Case saddle(double height) {
    constexpr double kSide = 100.0;
    Case made;
    made.foliation = testing::one_cylinder(
        testing::make_chart({.across = 40,
                             .along = 40,
                             .width = kSide,
                             .height = kSide,
                             .position = [height](double u, double v) {
                                 return Eigen::Vector3d(kSide * u, kSide * v,
                                                        height * (2.0 * u - 1.0) * (2.0 * v - 1.0));
                             }}));
    made.options.strip_width_mm = 10.0;
    return made;
}

QuadMesh built(const Case& from, Planarity planar, const Context& context = {}) {
    GridOptions options = from.options;
    options.planar = planar;
    return build_quad_mesh(from.foliation, options, context);
}

TriangleMesh charts_of(const Foliation& foliation) {
    TriangleMesh all;
    for (const Cylinder& cylinder : foliation.cylinders) {
        const int base = static_cast<int>(all.positions.size());
        all.positions.insert(all.positions.end(), cylinder.mesh.positions.begin(),
                             cylinder.mesh.positions.end());
        for (const auto& [a, b, c] : cylinder.mesh.triangles) {
            all.triangles.push_back({a + base, b + base, c + base});
        }
    }
    return all;
}

Quality quality_of(const Case& from, const QuadMesh& mesh) {
    return measure_quality(mesh, ClosestPoint(charts_of(from.foliation))).overall;
}

CellCorners corners_of(const QuadMesh& mesh, std::size_t quad) {
    CellCorners corners;
    for (std::size_t i = 0; i < 4; ++i) {
        corners[i] = mesh.vertices[at(mesh.quads[quad][i])];
    }
    return corners;
}

// Neither concave nor turned over against the surface below.
void expect_no_inverted(const Case& from, const QuadMesh& mesh) {
    const TriangleMesh surface = charts_of(from.foliation);
    const ClosestPoint closest(surface);
    for (std::size_t quad = 0; quad < mesh.quads.size(); ++quad) {
        const CellCorners cell = corners_of(mesh, quad);
        EXPECT_GT(smallest_sine(cell), 0.0) << quad;
        const auto hit = closest.query(0.25 * (cell[0] + cell[1] + cell[2] + cell[3]));
        const auto& [a, b, c] = surface.triangles[at(hit.triangle)];
        const Eigen::Vector3d& origin = surface.positions[at(a)];
        const Eigen::Vector3d outward =
            (surface.positions[at(b)] - origin).cross(surface.positions[at(c)] - origin);
        EXPECT_GT((cell[2] - cell[0]).cross(cell[3] - cell[1]).dot(outward), 0.0) << quad;
    }
}

class Planarise : public ::testing::TestWithParam<Junctions> {};

TEST_P(Planarise, FullHoldsItsBoundForEveryCell) {
    const Case from = eight(GetParam());
    const Quality before = quality_of(from, built(from, Planarity::Off));
    const QuadMesh mesh = built(from, Planarity::Full);
    const Quality after = quality_of(from, mesh);
    ASSERT_TRUE(mesh.planarisation);
    EXPECT_TRUE(mesh.planarisation->reached);
    EXPECT_GT(before.planarity_percent.max, 5.0);
    EXPECT_LE(after.planarity_percent.max, 0.1);
    // What a net of this kind has been seen to cost, and half as much again.
    EXPECT_LT(after.angle_deviation_deg.avg, before.angle_deviation_deg.avg + 5.0);
    EXPECT_LT(after.surface_distance_percent.avg, 4.0 * before.surface_distance_percent.avg);
    expect_no_inverted(from, mesh);
}

TEST_P(Planarise, GentleUsesItsAngleAndNoMore) {
    const Case from = eight(GetParam());
    const Quality before = quality_of(from, built(from, Planarity::Off));
    const QuadMesh mesh = built(from, Planarity::Gentle);
    const Quality after = quality_of(from, mesh);
    EXPECT_LE(after.angle_deviation_deg.avg, before.angle_deviation_deg.avg + kGentleAngleDeg);
    EXPECT_GE(after.angle_deviation_deg.avg,
              before.angle_deviation_deg.avg + 0.95 * kGentleAngleDeg);
    EXPECT_LT(after.planarity_percent.avg, 0.8 * before.planarity_percent.avg);
    expect_no_inverted(from, mesh);
}

TEST_P(Planarise, ChangesNothingButPlaces) {
    const Case from = eight(GetParam());
    const QuadMesh off = built(from, Planarity::Off);
    const QuadMesh full = built(from, Planarity::Full);
    EXPECT_FALSE(off.planarisation);
    EXPECT_EQ(off.quads, full.quads);
    EXPECT_EQ(off.vertices.size(), full.vertices.size());
    EXPECT_EQ(off.addresses.size(), full.addresses.size());
    double area_off = 0.0;
    double area_full = 0.0;
    for (std::size_t quad = 0; quad < off.quads.size(); ++quad) {
        area_off += off.surface_area[quad];
        area_full += full.surface_area[quad];
        EXPECT_GT(full.surface_area[quad], 0.0);
    }
    EXPECT_NEAR(area_full, area_off, 1e-9 * area_off);
}

TEST_P(Planarise, TellsThePriceAsMeasured) {
    const Case from = eight(GetParam());
    const QuadMesh off = built(from, Planarity::Off);
    const QuadMesh full = built(from, Planarity::Full);
    const Quality before = quality_of(from, off);
    const Quality after = quality_of(from, full);
    const PlanarisationPrice& price = *full.planarisation;
    EXPECT_DOUBLE_EQ(price.before.angle_deviation_avg_deg, before.angle_deviation_deg.avg);
    EXPECT_DOUBLE_EQ(price.after.angle_deviation_avg_deg, after.angle_deviation_deg.avg);
    EXPECT_DOUBLE_EQ(price.after.planarity_max_percent, after.planarity_percent.max);
    EXPECT_DOUBLE_EQ(price.after.surface_distance_avg_percent, after.surface_distance_percent.avg);
    double furthest = 0.0;
    for (std::size_t v = 0; v < off.vertices.size(); ++v) {
        furthest = std::max(furthest, (off.vertices[v] - full.vertices[v]).norm());
    }
    EXPECT_DOUBLE_EQ(price.largest_displacement_mm, furthest);
}

INSTANTIATE_TEST_SUITE_P(Junctions,
                         Planarise,
                         ::testing::Values(Junctions::Conforming, Junctions::Independent),
                         [](const auto& tested) {
                             return tested.param == Junctions::Conforming ? "Conforming"
                                                                          : "Independent";
                         });

TEST(Planarise, LeavesPlanarMeshesAsTheyAre) {
    for (const Planarity planar : {Planarity::Gentle, Planarity::Full}) {
        for (const Foliation& foliation :
             {testing::flat_rectangle(100.0, 60.0), testing::round_cylinder(20.0, 80.0),
              testing::round_torus(100.0, 25.0)}) {
            Case from;
            from.foliation = foliation;
            const QuadMesh mesh = built(from, planar);
            EXPECT_EQ(mesh.vertices, built(from, Planarity::Off).vertices);
            EXPECT_TRUE(mesh.planarisation->reached);
            EXPECT_EQ(mesh.planarisation->largest_displacement_mm, 0.0);
        }
    }
}

TEST(Planarise, KeepsVerticesOnTheBoundary) {
    const Case from = saddle(20.0);
    const QuadMesh off = built(from, Planarity::Off);
    const QuadMesh full = built(from, Planarity::Full);
    EXPECT_TRUE(full.planarisation->reached);
    const QuadNeighbours neighbours = find_neighbours(off.quads);
    const double width = from.options.strip_width_mm;
    double furthest = 0.0;
    for (std::size_t quad = 0; quad < off.quads.size(); ++quad) {
        for (std::size_t side = 0; side < 4; ++side) {
            if (neighbours.across[quad][side].quad < 0) {
                const Eigen::Vector3d& point = full.vertices[at(off.quads[quad][side])];
                const double x = std::min(point.x(), 100.0 - point.x());
                const double y = std::min(point.y(), 100.0 - point.y());
                furthest = std::max(furthest, std::abs(std::min(x, y)));
            }
        }
    }
    EXPECT_LT(furthest, 0.5 * width);
}

TEST(Planarise, KeepsTheSymmetryOfWhatItGets) {
    // A bowl whose lines of curvature run askew to the leaves. Half a turn about its middle takes
    // vertex i to the last but i. Triangles are fine enough for their facets not to matter much.
    Case from;
    from.foliation = testing::one_cylinder(testing::make_chart(
        {.across = 101,
         .along = 101,
         .width = 100.0,
         .height = 100.0,
         .position = [](double u, double v) {
             const double x = 2.0 * u - 1.0;
             const double y = 2.0 * v - 1.0;
             return Eigen::Vector3d(100.0 * u, 100.0 * v, 10.0 * (x * x + y * y + 0.5 * x * y));
         }}));
    from.options.strip_width_mm = 10.0;
    const QuadMesh mesh = built(from, Planarity::Full);
    EXPECT_TRUE(mesh.planarisation->reached);
    EXPECT_GT(mesh.planarisation->largest_displacement_mm, 0.1);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const Eigen::Vector3d& other = mesh.vertices[mesh.vertices.size() - 1 - v];
        const Eigen::Vector3d turned(100.0 - other.x(), 100.0 - other.y(), other.z());
        EXPECT_LT((mesh.vertices[v] - turned).norm(), 2e-3 * from.options.strip_width_mm) << v;
    }
}

TEST(Planarise, GivesTheSameOnAnyNumberOfThreads) {
    const Case from = eight(Junctions::Conforming);
    Context several;
    several.threads = 3;
    EXPECT_EQ(built(from, Planarity::Full).vertices,
              built(from, Planarity::Full, several).vertices);
}

TEST(Planarise, StopsOnRequest) {
    const Case from = saddle(20.0);
    QuadMesh mesh = built(from, Planarity::Off);
    std::stop_source source;
    source.request_stop();
    Context context;
    context.stop = source.get_token();
    EXPECT_THROW(planarise(mesh, from.foliation, Planarity::Full, context), Cancelled);
}

double extent_of(const CellCorners& corners) {
    const double diagonal =
        0.5 * ((corners[2] - corners[0]).norm() + (corners[3] - corners[1]).norm());
    return diagonal * bend_of(corners) / twist_of(corners);
}

TEST(PlanarCell, HasTheGradientsOfItsRows) {
    const CellCorners start = {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0),
                               Eigen::Vector3d(1.1, 1, 0), Eigen::Vector3d(0, 0.9, 0)};
    const CellCorners corners = {Eigen::Vector3d(0.1, 0, 0.1), Eigen::Vector3d(1.2, 0.1, -0.1),
                                 Eigen::Vector3d(1.1, 1.2, 0.2), Eigen::Vector3d(-0.1, 0.9, 0)};
    const CellWishes wishes{.planarity = 3.0, .pull = 0.5, .firmness = 2.0};
    CellResidual residual;
    CellJacobian jacobian;
    cell_rows(start, corners, wishes, residual, &jacobian);
    constexpr double kStep = 1e-6;
    for (int unknown = 0; unknown < 12; ++unknown) {
        std::array<CellResidual, 2> shifted;
        for (const int side : {0, 1}) {
            CellCorners moved = corners;
            moved[at(unknown / 3)][unknown % 3] += side == 0 ? -kStep : kStep;
            cell_rows(start, moved, wishes, shifted[at(side)], nullptr);
        }
        const CellResidual slope = (shifted[1] - shifted[0]) / (2.0 * kStep);
        // The cell's extent is taken as constant in the row of planarity.
        const int rows = kCellRows - 1;
        EXPECT_LT((slope - jacobian.col(unknown)).head(rows).cwiseAbs().maxCoeff(), 1e-7);
        CellCorners ahead = corners;
        ahead[at(unknown / 3)][unknown % 3] += kStep;
        const double by_extent = wishes.planarity * twist_of(corners) *
                                 (1.0 - extent_of(ahead) / extent_of(corners)) / kStep;
        EXPECT_NEAR(slope[rows] - by_extent, jacobian(rows, unknown), 1e-5);
    }
}

TEST(CellBlocks, AddUpToTheDenseMatrix) {
    const std::vector<std::array<int, 4>> quads = {{0, 1, 3, 2}, {5, 2, 3, 4}, {1, 6, 6, 3}};
    CellBlocks blocks(7, quads);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(21, 21);
    std::minstd_rand random(1);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    for (std::size_t cell = 0; cell < quads.size(); ++cell) {
        Eigen::Matrix<double, 12, 12> half;
        for (int i = 0; i < 144; ++i) {
            half(i / 12, i % 12) = number(random);
        }
        const Eigen::Matrix<double, 12, 12> block = half + half.transpose();
        blocks.add_cell(cell, block);
        for (int i = 0; i < 12; ++i) {
            for (int j = 0; j < 12; ++j) {
                dense(3 * quads[cell][at(i / 3)] + i % 3, 3 * quads[cell][at(j / 3)] + j % 3) +=
                    block(i, j);
            }
        }
    }
    blocks.add_vertex(4, 2.0 * Eigen::Matrix3d::Identity());
    dense.block<3, 3>(12, 12) += 2.0 * Eigen::Matrix3d::Identity();
    const SymmetricMatrix& matrix = blocks.matrix();
    ASSERT_EQ(matrix.size, 21);
    Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(21, 21);
    for (int column = 0; column < 21; ++column) {
        for (int i = matrix.column_start[at(column)]; i < matrix.column_start[at(column + 1)];
             ++i) {
            EXPECT_GE(matrix.row[at(i)], column);
            lower(matrix.row[at(i)], column) += matrix.value[at(i)];
        }
    }
    const Eigen::MatrixXd wanted = dense.triangularView<Eigen::Lower>();
    EXPECT_LT((lower - wanted).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace leafcutter::geometry
