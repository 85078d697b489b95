#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/closest_point.h"
#include "geometry/quads/mean_widths.h"
#include "geometry/quads/quad_edges.h"
#include "geometry/quads/quad_mesh.h"
#include "geometry/quads/quality.h"
#include "tests/geometry/charts.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Vector3d;

GridOptions counts(int rows, int cols) {
    GridOptions options;
    options.all = {.rows = rows, .cols = cols};
    return options;
}

GridOptions width_mm(double width) {
    GridOptions options;
    options.strip_width_mm = width;
    return options;
}

int euler(const QuadMesh& mesh) {
    return static_cast<int>(mesh.vertices.size() + mesh.quads.size()) -
           find_neighbours(mesh.quads).edges;
}

double sum(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

const Vector3d& corner(const QuadMesh& mesh, std::size_t quad, std::size_t which) {
    return mesh.vertices[static_cast<std::size_t>(mesh.quads[quad][which])];
}

std::string refusal(const Foliation& foliation, const GridOptions& options, ErrorKind kind) {
    try {
        build_quad_mesh(foliation, options);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind);
        return error.what();
    }
    return "accepted";
}

TEST(QuadMesh, OfAFlatSquareIsTheExactGrid) {
    const QuadMesh mesh = build_quad_mesh(testing::flat_rectangle(40.0, 30.0, 7, 9), counts(3, 4));
    ASSERT_EQ(mesh.quads.size(), 12U);
    ASSERT_EQ(mesh.vertices.size(), 20U);
    for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
        const QuadAddress& at = mesh.addresses[i];
        const Vector3d a(10.0 * at.col, 10.0 * at.row, 0.0);
        EXPECT_LT((corner(mesh, i, 0) - a).norm(), 1e-12);
        EXPECT_LT((corner(mesh, i, 1) - a - Vector3d(10, 0, 0)).norm(), 1e-12);
        EXPECT_LT((corner(mesh, i, 2) - a - Vector3d(10, 10, 0)).norm(), 1e-12);
        EXPECT_LT((corner(mesh, i, 3) - a - Vector3d(0, 10, 0)).norm(), 1e-12);
        EXPECT_NEAR(mesh.surface_area[i], 100.0, 1e-10);
    }
}

TEST(QuadMesh, TakesSquareCellsOfTheWishedWidth) {
    const QuadMesh mesh = build_quad_mesh(testing::flat_rectangle(210.0, 300.0), width_mm(10.0));
    EXPECT_EQ(mesh.grids[0].rows, 30);
    EXPECT_EQ(mesh.grids[0].cols, 21);
}

// A flat square whose chart squeezes its right half by the factor 4 in g: f is not conformal to it,
// but only the levels matter here.
Foliation squeezed_square() {
    const auto place = [](double u) { return u < 0.8 ? 0.625 * u : 0.5 + 2.5 * (u - 0.8); };
    return testing::one_cylinder(testing::make_chart({.shape = ChartShape::Rectangle,
                                                      .across = 40,
                                                      .along = 4,
                                                      .width = 100.0,
                                                      .height = 100.0,
                                                      .position = [=](double u, double v) {
                                                          return Vector3d(100.0 * place(u),
                                                                          100.0 * v, 0.0);
                                                      }}));
}

TEST(QuadMesh, GradesLevelsTowardsWhereTheChartIsSqueezed) {
    const QuadMesh mesh = build_quad_mesh(squeezed_square(), counts(4, 10));
    std::vector<double> widths;
    for (std::size_t col = 0; col < 10; ++col) {
        widths.push_back((corner(mesh, col, 1) - corner(mesh, col, 0)).norm());
    }
    // Even levels would give 6.25 mm and 25 mm. The scale goes with the square root of the squeeze
    // in one direction, so half of the difference (in logarithms) is left.
    EXPECT_NEAR(widths.back() / widths.front(), 2.0, 0.05);
    EXPECT_NEAR(sum(widths), 100.0, 1e-9);
}

TEST(QuadMesh, MakesCellsEvenWhereOneCoordinateCanDoIt) {
    const QuadMesh torus =
        build_quad_mesh(testing::round_torus(100.0, 25.0, 96, 256), counts(64, 16));
    double largest = 0.0;
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < torus.quads.size(); ++i) {
        const double tube = (corner(torus, i, 1) - corner(torus, i, 0)).norm();
        largest = std::max(largest, tube);
        smallest = std::min(smallest, tube);
    }
    // All strips around the big circle are equally wide although the scale goes from 75 to 125.
    EXPECT_LT(largest, 1.03 * smallest);
}

TEST(QuadMesh, GivesSquareCellsWhereOneCountIsFixed) {
    GridOptions options;
    options.all.rows = 12;
    const QuadMesh mesh = build_quad_mesh(testing::flat_rectangle(210.0, 300.0), options);
    EXPECT_EQ(mesh.grids[0].rows, 12);
    EXPECT_NEAR(mesh.grids[0].cols, 8.4, 1.0);
}

TEST(QuadMesh, PrefersTheCountsOfTheCylinder) {
    GridOptions options = counts(5, 5);
    options.per_cylinder = {{.rows = 2, .cols = 3}};
    const QuadMesh mesh = build_quad_mesh(testing::flat_rectangle(10.0, 10.0), options);
    EXPECT_EQ(mesh.quads.size(), 6U);
}

TEST(QuadMesh, ClosesRingsEvenlyForThePlainWeave) {
    const Foliation cylinder = testing::round_cylinder(35.0, 100.0);
    for (const double width : {3.0, 7.0, 11.0, 17.0, 1000.0}) {
        const QuadMesh mesh = build_quad_mesh(cylinder, width_mm(width));
        EXPECT_EQ(mesh.grids[0].cols % 2, 0);
        EXPECT_GE(mesh.grids[0].cols, 4);
        EXPECT_EQ(euler(mesh), 0);
        EXPECT_EQ(find_neighbours(mesh.quads).boundary_edges, 2 * mesh.grids[0].cols);
        EXPECT_EQ(find_neighbours(mesh.quads).faults, 0);
    }
}

TEST(QuadMesh, PutsRingsOfACylinderAtExactHeights) {
    GridOptions options = counts(4, 6);
    options.half_sag_offset = false;
    const QuadMesh mesh = build_quad_mesh(testing::round_cylinder(10.0, 20.0), options);
    for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
        EXPECT_NEAR(corner(mesh, i, 0).z(), 5.0 * mesh.addresses[i].row, 1e-12);
        EXPECT_NEAR(corner(mesh, i, 2).z(), 5.0 * mesh.addresses[i].row + 5.0, 1e-12);
        EXPECT_NEAR(corner(mesh, i, 0).head<2>().norm(), 10.0, 1e-12);
    }
}

TEST(QuadMesh, FacesOutwards) {
    const QuadMesh mesh = build_quad_mesh(testing::round_torus(100.0, 25.0), width_mm(10.0));
    for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
        const Vector3d normal = (corner(mesh, i, 2) - corner(mesh, i, 0))
                                    .cross(corner(mesh, i, 3) - corner(mesh, i, 1));
        const Vector3d centre = 0.25 * (corner(mesh, i, 0) + corner(mesh, i, 1) +
                                        corner(mesh, i, 2) + corner(mesh, i, 3));
        const Vector3d core = 100.0 * Vector3d(centre.x(), centre.y(), 0.0).normalized();
        EXPECT_GT(normal.dot(centre - core), 0.0);
    }
}

TEST(QuadMesh, OfATorusIsClosedWithEveryVertexOnFourQuads) {
    const QuadMesh mesh = build_quad_mesh(testing::round_torus(100.0, 25.0), width_mm(9.0));
    EXPECT_EQ(euler(mesh), 0);
    const QuadNeighbours found = find_neighbours(mesh.quads);
    EXPECT_EQ(found.boundary_edges, 0);
    EXPECT_EQ(found.faults, 0);
    EXPECT_EQ(mesh.vertices.size(), mesh.quads.size());
    EXPECT_EQ(mesh.grids[0].column_shift, 0);
    EXPECT_EQ(mesh.grids[0].rows % 2, 0);
    EXPECT_EQ(mesh.grids[0].cols % 2, 0);
}

TEST(QuadMesh, ClosesASlantedTorusAfterAWholeShift) {
    const Foliation torus = testing::slanted_torus(157.0, 630.0, 50.0);
    const double own_deg = std::atan(50.0 / 630.0) * 180.0 / std::numbers::pi;
    for (const double width : {4.0, 9.0, 15.0}) {
        const QuadMesh mesh = build_quad_mesh(torus, width_mm(width));
        const CylinderGrid& grid = mesh.grids[0];
        EXPECT_NE(grid.column_shift, 0);
        EXPECT_EQ((grid.rows + grid.column_shift) % 2, 0);
        EXPECT_LT(std::abs(grid.shear_deg), 0.5 * own_deg);
        EXPECT_EQ(euler(mesh), 0);
        EXPECT_EQ(find_neighbours(mesh.quads).boundary_edges, 0);
        EXPECT_EQ(find_neighbours(mesh.quads).faults, 0);
        // No edge is longer than a few cells: the seam joins what belongs together.
        for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
            for (std::size_t k = 0; k < 4; ++k) {
                EXPECT_LT((corner(mesh, i, k) - corner(mesh, i, (k + 1) % 4)).norm(), 3 * width);
            }
        }
    }
}

TEST(QuadMesh, KeepsAnAlmostSquareTorusAligned) {
    const double shear = 630.0 * std::tan(0.9 * std::numbers::pi / 180.0);
    const QuadMesh mesh =
        build_quad_mesh(testing::slanted_torus(157.0, 630.0, shear), width_mm(5.0));
    EXPECT_EQ(mesh.grids[0].column_shift, 0);
    EXPECT_NEAR(mesh.grids[0].shear_deg, 0.9, 1e-9);
}

TEST(QuadMesh, StandsForTheWholeSurface) {
    for (const Foliation& foliation :
         {testing::flat_rectangle(210.0, 300.0), testing::round_cylinder(35.0, 100.0),
          testing::round_torus(100.0, 25.0), testing::slanted_torus(157.0, 630.0, 50.0)}) {
        const double area = testing::area_of(foliation.cylinders[0].mesh);
        for (const double width : {3.0, 8.0, 30.0}) {
            const QuadMesh mesh = build_quad_mesh(foliation, width_mm(width));
            EXPECT_NEAR(sum(mesh.surface_area), area, 1e-9 * area);
        }
    }
}

TEST(QuadMesh, SplitsTheAreaOfARoundTorusAsTheFormulaSays) {
    // The cell between tube angles stands for its share of 2 pi r (R t + r sin t).
    const Foliation torus = testing::round_torus(100.0, 25.0, 192, 64);
    const QuadMesh mesh = build_quad_mesh(torus, counts(16, 8));
    const double root = std::sqrt(100.0 * 100.0 - 25.0 * 25.0);
    const auto tube_angle = [&](double g) {
        const double half = 0.5 * g * root / 25.0 - 0.5 * std::numbers::pi;
        return 2.0 * std::atan(std::sqrt(125.0 / 75.0) * std::tan(half));
    };
    const auto band = [](double angle) { return 25.0 * (100.0 * angle + 25.0 * std::sin(angle)); };
    const auto& levels = mesh.grids[0].g_levels;
    for (std::size_t col = 1; col + 1 < 8; ++col) {
        const double exact = (band(tube_angle(levels[col + 1])) - band(tube_angle(levels[col]))) *
                             2.0 * std::numbers::pi / 16.0;
        EXPECT_NEAR(mesh.surface_area[col], exact, 5e-3 * exact);
    }
}

TEST(QuadMesh, PutsVerticesOnTheSurfaceWithoutOffset) {
    const Foliation torus = testing::round_torus(100.0, 25.0);
    GridOptions options = width_mm(9.0);
    options.half_sag_offset = false;
    const QuadMesh mesh = build_quad_mesh(torus, options);
    const ClosestPoint surface(torus.cylinders[0].mesh);
    for (const Vector3d& vertex : mesh.vertices) {
        EXPECT_LT(surface.query(vertex).distance, 1e-11);
    }
}

TEST(QuadMesh, OffsetHalvesTheSagOfARoundCylinder) {
    const QuadMesh mesh =
        build_quad_mesh(testing::round_cylinder(10.0, 20.0, 960, 2), counts(2, 12));
    const double sag = 10.0 * (1.0 - std::cos(std::numbers::pi / 12.0));
    for (const Vector3d& vertex : mesh.vertices) {
        // Both quads at a vertex lean by half a cell: their mean normal is that much shorter.
        EXPECT_NEAR(vertex.head<2>().norm(), 10.0 + 0.5 * sag * std::cos(std::numbers::pi / 12.0),
                    1e-3 * sag);
    }
}

TEST(QuadMesh, KeepsBoundaryVerticesOnTheBoundary) {
    GridOptions options = width_mm(4.0);
    options.half_sag_offset = false;
    const QuadMesh mesh = build_quad_mesh(testing::flat_rectangle(33.0, 21.0, 8, 5), options);
    double low_x = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
        if (mesh.addresses[i].col == 0) {
            EXPECT_EQ(corner(mesh, i, 0).x(), 0.0);
        }
        if (mesh.addresses[i].row + 1 == mesh.grids[0].rows) {
            EXPECT_DOUBLE_EQ(corner(mesh, i, 2).y(), 21.0);
        }
        low_x = std::min(low_x, corner(mesh, i, 0).x());
    }
    EXPECT_EQ(low_x, 0.0);
}

TEST(QuadMesh, RefusesCountsThatCannotCarryTheTopology) {
    const Foliation cylinder = testing::round_cylinder(35.0, 100.0);
    EXPECT_NE(refusal(cylinder, counts(3, 2), ErrorKind::BadOption).find("grid.cols: 2"),
              std::string::npos);
    EXPECT_NE(refusal(cylinder, counts(3, 7), ErrorKind::BadOption).find("even"),
              std::string::npos);
    EXPECT_NE(refusal(cylinder, counts(0, 8), ErrorKind::BadOption).find("at least 1"),
              std::string::npos);
    const Foliation torus = testing::round_torus(100.0, 25.0);
    EXPECT_NE(refusal(torus, counts(2, 8), ErrorKind::BadOption).find("grid.rows: 2"),
              std::string::npos);
    EXPECT_NE(refusal(torus, counts(7, 8), ErrorKind::BadOption).find("grid.rows: 7"),
              std::string::npos);
    GridOptions own;
    own.per_cylinder = {{.rows = std::nullopt, .cols = 1}};
    GridOptions more;
    more.per_cylinder.resize(2);
    EXPECT_EQ(refusal(torus, more, ErrorKind::BadOption).find("grid.cylinders: has 2"), 0U);
    EXPECT_NE(refusal(torus, own, ErrorKind::BadOption).find("grid.cylinders[0].cols"),
              std::string::npos);
}

TEST(QuadMesh, TakesOddCountsWhereParityIsFree) {
    GridOptions options = counts(7, 9);
    options.parity = Parity::Any;
    const QuadMesh mesh = build_quad_mesh(testing::round_torus(100.0, 25.0), options);
    EXPECT_EQ(mesh.quads.size(), 63U);
}

TEST(QuadMesh, RefusesWidthsThatMakeNoSense) {
    const Foliation square = testing::flat_rectangle(100.0, 100.0);
    for (const double width : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), 1e-6}) {
        EXPECT_NE(refusal(square, width_mm(width), ErrorKind::BadOption).find("grid"),
                  std::string::npos);
    }
}

TEST(QuadMesh, KeepsSeveralCylindersApart) {
    Foliation two = testing::flat_rectangle(100.0, 100.0);
    two.cylinders.push_back(testing::round_cylinder(20.0, 50.0).cylinders[0]);
    const QuadMesh mesh = build_quad_mesh(two, width_mm(10.0));  // Nothing to join them by.
    ASSERT_EQ(mesh.grids.size(), 2U);
    EXPECT_EQ(euler(mesh), 1 + 0);
    EXPECT_EQ(mesh.addresses.front().cylinder, 0);
    EXPECT_EQ(mesh.addresses.back().cylinder, 1);
}

// 100 mm of flat sheet, then 100 mm rolled up to a radius of 40 mm. Isometric to its chart.
Foliation rolled_sheet() {
    return testing::one_cylinder(testing::make_chart(
        {.shape = ChartShape::Rectangle,
         .across = 400,
         .along = 10,
         .width = 200.0,
         .height = 100.0,
         .position = [](double u, double v) {
             const double arc = std::max(200.0 * u - 100.0, 0.0) / 40.0;
             const double flat = std::min(200.0 * u, 100.0);
             return Vector3d(flat + 40.0 * std::sin(arc), 100.0 * v, 40.0 * (1.0 - std::cos(arc)));
         }}));
}

TEST(QuadMesh, NarrowsStripsWhereTheSurfaceBendsIfAsked) {
    const Foliation sheet = rolled_sheet();
    const ClosestPoint surface(sheet.cylinders[0].mesh);
    const double even = measure_quality(build_quad_mesh(sheet, counts(10, 20)), surface)
                            .overall.surface_distance_percent.max;
    for (const Spacing spacing : {Spacing::Curvature, Spacing::CurvatureArea}) {
        GridOptions options = counts(10, 20);
        options.spacing = spacing;
        const QuadMesh mesh = build_quad_mesh(sheet, options);
        const auto& levels = mesh.grids[0].g_levels;
        EXPECT_GT(levels[1] - levels[0], 1.5 * (levels[20] - levels[19]));
        EXPECT_TRUE(std::is_sorted(levels.begin(), levels.end()));
        const MaxAvg found = measure_quality(mesh, surface).overall.surface_distance_percent;
        EXPECT_LT(found.max, 0.8 * even);
        // Along the other family nothing bends, so nothing moves.
        EXPECT_NEAR(mesh.grids[0].f_levels[1], 10.0, 1e-9);
    }
}

TEST(QuadMesh, KeepsEvenLevelsWhereNothingBends) {
    GridOptions options = counts(5, 7);
    options.spacing = Spacing::Curvature;
    const QuadMesh mesh = build_quad_mesh(testing::flat_rectangle(70.0, 50.0), options);
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_NEAR(mesh.grids[0].g_levels[i], 10.0 * static_cast<double>(i), 1e-9);
    }
}

// Bumps of several sizes on a sheet: some rows and columns bend much more than others.
Foliation bumpy_sheet() {
    return testing::one_cylinder(testing::make_chart(
        {.shape = ChartShape::Rectangle,
         .across = 96,
         .along = 72,
         .width = 160.0,
         .height = 120.0,
         .position = [](double u, double v) {
             const auto bump = [&](double x, double y, double size) {
                 const double far = std::hypot(160.0 * u - x, 120.0 * v - y) / size;
                 return size * std::exp(-far * far);
             };
             return Vector3d(160.0 * u, 120.0 * v, bump(35.0, 80.0, 8.0) + bump(110.0, 35.0, 14.0));
         }}));
}

TEST(QuadMesh, ComesCloserByGradedStripsAtTheSameCounts) {
    const Foliation sheet = bumpy_sheet();
    const ClosestPoint surface(sheet.cylinders[0].mesh);
    const auto distance = [&](const QuadMesh& mesh) {
        return measure_quality(mesh, surface).overall.surface_distance_percent;
    };
    const MaxAvg even = distance(build_quad_mesh(sheet, counts(18, 24)));
    std::vector<double> largest;
    for (const Spacing spacing : {Spacing::Curvature, Spacing::CurvatureArea}) {
        GridOptions options = counts(18, 24);
        options.spacing = spacing;
        const QuadMesh mesh = build_quad_mesh(sheet, options);
        const CylinderGrid& grid = mesh.grids[0];
        EXPECT_EQ(grid.rows, 18);
        EXPECT_EQ(grid.cols, 24);
        for (const auto* levels : {&grid.f_levels, &grid.g_levels}) {
            for (std::size_t i = 0; i + 1 < levels->size(); ++i) {
                EXPECT_LT((*levels)[i], (*levels)[i + 1]);
            }
        }
        EXPECT_EQ(grid.f_levels.back(), 120.0);
        EXPECT_EQ(grid.g_levels.back(), 160.0);
        largest.push_back(distance(mesh).max);
        EXPECT_LT(distance(mesh).avg, 1.02 * even.avg);
    }
    EXPECT_LT(largest[0], 0.9 * even.max);
    EXPECT_LT(largest[1], 0.55 * even.max);
}

TEST(QuadMesh, GradesTheSameOnAnyNumberOfThreads) {
    const Foliation sheet = bumpy_sheet();
    GridOptions options = counts(9, 12);
    options.spacing = Spacing::CurvatureArea;
    Context several;
    several.threads = 3;
    const QuadMesh one = build_quad_mesh(sheet, options);
    const QuadMesh three = build_quad_mesh(sheet, options, several);
    EXPECT_EQ(one.grids[0].f_levels, three.grids[0].f_levels);
    EXPECT_EQ(one.grids[0].g_levels, three.grids[0].g_levels);
}

TEST(QuadMesh, KeepsTheMeanWidthOfStrips) {
    for (const Foliation& foliation :
         {testing::flat_rectangle(210.0, 300.0), squeezed_square(), bumpy_sheet(),
          testing::round_torus(100.0, 25.0), testing::slanted_torus(157.0, 630.0, 50.0)}) {
        for (const double width : {3.0, 4.0, 5.5}) {
            const MeanWidths found = mean_widths(build_quad_mesh(foliation, width_mm(width)));
            EXPECT_NEAR(found.all_mm(), width, 0.02 * width);
        }
    }
}

TEST(QuadMesh, SaysWhatWidthStripsHaveInstead) {
    // Four columns at least close a ring, so they can't be as wide as this.
    const QuadMesh mesh = build_quad_mesh(testing::round_cylinder(5.0, 300.0), width_mm(40.0));
    const double width = mean_widths(mesh).all_mm();
    EXPECT_LT(width, 0.98 * 40.0);
    EXPECT_TRUE(std::any_of(mesh.warnings.begin(), mesh.warnings.end(), [](const auto& warning) {
        return warning.find("on average instead of 40 mm") != std::string::npos;
    }));
}

TEST(QuadMesh, StopsWhenAsked) {
    std::stop_source source;
    source.request_stop();
    Context context;
    context.stop = source.get_token();
    EXPECT_THROW(build_quad_mesh(testing::flat_rectangle(9.0, 9.0), {}, context), Cancelled);
}

}  // namespace
}  // namespace leafcutter::geometry
