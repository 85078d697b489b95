// Grids of single cylinders: no other is less distorted, and colours alternate.

#include <algorithm>
#include <cmath>
#include <queue>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/quads/grid.h"
#include "geometry/quads/quad_edges.h"
#include "geometry/quads/quad_mesh.h"
#include "geometry/quads/spacing.h"
#include "geometry/surface_measures.h"
#include "tests/geometry/charts.h"

namespace leafcutter::geometry {
namespace {

bool alternates(const QuadMesh& mesh) {
    const QuadNeighbours neighbours = find_neighbours(mesh.quads);
    std::vector<int> colour(mesh.quads.size(), -1);
    colour[0] = 0;
    std::queue<std::size_t> next({0});
    for (; !next.empty(); next.pop()) {
        for (const QuadSide& side : neighbours.across[next.front()]) {
            if (side.quad < 0) {
                continue;
            }
            int& other = colour[static_cast<std::size_t>(side.quad)];
            if (other < 0) {
                other = 1 - colour[next.front()];
                next.push(static_cast<std::size_t>(side.quad));
            } else if (other == colour[next.front()]) {
                return false;
            }
        }
    }
    return true;
}

// What is to be small: the slant at four times the logarithms of stretch, the number of cells
// within 3 %.
double distortion(const Cylinder& chart, double aspect, const CylinderGrid& grid, double cells) {
    const double count = static_cast<double>(grid.rows) * grid.cols;
    const double off = std::max(0.0, std::abs(std::log(count / cells)) - 0.03);
    const double slant = (chart.shear - grid.column_shift * chart.width / grid.cols) / chart.height;
    const double stretch = std::log(aspect * grid.cols / grid.rows);
    return 20.0 * off * off + stretch * stretch + 16.0 * slant * slant;
}

double least_distortion(const Cylinder& chart, double aspect, double cells) {
    double least = 1e300;
    for (int cols = 4; cols <= 2 * static_cast<int>(cells); cols += 2) {
        for (int rows = 3; rows * cols <= 4.0 * cells + 100.0; ++rows) {
            for (int shift = -cols; shift <= cols; ++shift) {
                if ((rows + shift) % 2 == 0) {
                    CylinderGrid grid;
                    grid.rows = rows;
                    grid.cols = cols;
                    grid.column_shift = shift;
                    least = std::min(least, distortion(chart, aspect, grid, cells));
                }
            }
        }
    }
    return least;
}

TEST(GridChoice, OfATorusIsTheLeastDistorted) {
    for (const double shear : {1.3, 2.6, 4.1}) {
        const Foliation torus = testing::slanted_torus(10.0, 37.0, shear);
        const Cylinder& chart = torus.cylinders.front();
        const double height =
            LevelScale(chart, Axis::G, chart.shear / chart.height).mean_even_leaf_mm();
        const double width = LevelScale(chart, Axis::F, 0.0).mean_leaf_mm();
        const double aspect = height / width;
        for (const double cells : {20.0, 55.0, 140.0, 310.0}) {
            GridWish wish;
            wish.cells = cells * height * width / surface_area(chart.mesh);
            const CylinderGrid grid = choose_grid(chart, wish);
            EXPECT_NEAR(distortion(chart, aspect, grid, cells),
                        least_distortion(chart, aspect, cells), 1e-6)
                << shear << ' ' << cells;
            EXPECT_EQ((grid.rows + grid.column_shift) % 2, 0);
        }
    }
}

TEST(GridChoice, LetsColoursAlternateRoundBothPeriods) {
    for (const double shear : {0.0, 1.3, 2.6}) {
        const Foliation torus = testing::slanted_torus(10.0, 40.0, shear);
        for (const double width : {11.0, 20.0, 31.0}) {
            GridOptions options;
            options.strip_width_mm = width;
            EXPECT_TRUE(alternates(build_quad_mesh(torus, options))) << shear << ' ' << width;
        }
    }
}

TEST(GridChoice, NamesTheWidestStripsThatCloseATorus) {
    const Foliation torus = testing::slanted_torus(10.0, 40.0, 2.6);
    GridOptions options;
    options.strip_width_mm = 180.0;
    const QuadMesh narrow = build_quad_mesh(torus, options);
    EXPECT_FALSE(narrow.warnings.empty());
    options.may_narrow = false;
    try {
        build_quad_mesh(torus, options);
        FAIL() << "three cells were taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::BadOption);
        EXPECT_EQ(error.code(), "strips-too-wide");
        const std::string what = error.what();
        const std::size_t place = what.find("use at most ");
        ASSERT_NE(place, std::string::npos);
        options.strip_width_mm = std::stod(what.substr(place + 12));
        EXPECT_EQ(build_quad_mesh(torus, options).quads.size(), narrow.quads.size());
    }
}

}  // namespace
}  // namespace leafcutter::geometry
