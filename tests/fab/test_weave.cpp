#include <numeric>

#include <gtest/gtest.h>

#include "fab/weave/weave.h"
#include "tests/support/quad_grids.h"

namespace leafcutter::fab {
namespace {

Weave weave(const geometry::QuadMesh& mesh, WeavePattern pattern) {
    WeaveParams params;
    params.pattern = pattern;
    return weave_cells(mesh, params);
}

int floats(const Weave& weave, int rows, int cols) {
    int longest = 0;
    for (int i = 0; i < rows; ++i) {
        int run = 1;
        for (int j = 1; j < cols; ++j) {
            const auto at = static_cast<std::size_t>(i * cols + j);
            run = weave.warp_on_top[at] == weave.warp_on_top[at - 1] ? run + 1 : 1;
            longest = std::max(longest, run);
        }
    }
    return longest;
}

TEST(WeaveCells, AlternatesPlainWeaveWithoutSeamsWhereCountsAreEven) {
    const auto mesh = test::torus_grid({6, 8}, 50.0, 15.0);
    const Weave result = weave(mesh, WeavePattern::Plain);
    EXPECT_TRUE(result.seams.empty());
    EXPECT_EQ(std::accumulate(result.warp_on_top.begin(), result.warp_on_top.end(), 0), 24);
    EXPECT_EQ(floats(result, 6, 8), 1);
}

TEST(WeaveCells, RepeatsTwillRoundATorusOfWholePeriods) {
    EXPECT_TRUE(weave(test::torus_grid({8, 12}, 50.0, 15.0), WeavePattern::Twill2x2).seams.empty());
    const Weave broken = weave(test::torus_grid({8, 10}, 50.0, 15.0), WeavePattern::Twill2x2);
    EXPECT_EQ(broken.seams.size(), 8U);
    EXPECT_TRUE(broken.shortest);
    EXPECT_GT(broken.seam_mm, 0.0);
}

TEST(WeaveCells, ListsTheSeamOfAnOddRing) {
    const auto mesh = test::cylinder_grid({4, 7}, 20.0, 30.0);
    const Weave result = weave(mesh, WeavePattern::Plain);
    ASSERT_EQ(result.seams.size(), 4U);
    for (const auto& [quad, next] : result.seams) {
        EXPECT_EQ(mesh.addresses[static_cast<std::size_t>(quad)].col, 6);
        EXPECT_EQ(mesh.addresses[static_cast<std::size_t>(next)].col, 0);
        EXPECT_EQ(result.warp_on_top[static_cast<std::size_t>(quad)],
                  result.warp_on_top[static_cast<std::size_t>(next)]);
    }
}

TEST(WeaveCells, KeepsDoubleLayersApart) {
    const auto mesh = test::flat_grid({3, 4}, 10.0);
    for (const std::uint8_t top : weave(mesh, WeavePattern::DoubleWarp).warp_on_top) {
        EXPECT_EQ(top, 1);
    }
    for (const std::uint8_t top : weave(mesh, WeavePattern::DoubleWeft).warp_on_top) {
        EXPECT_EQ(top, 0);
    }
}

TEST(WeaveCells, FloatsNoFurtherThanThePatternSays) {
    const auto mesh = test::flat_grid({20, 20}, 10.0);
    EXPECT_EQ(floats(weave(mesh, WeavePattern::Twill2x2), 20, 20), 2);
    EXPECT_EQ(floats(weave(mesh, WeavePattern::Basket2x2), 20, 20), 2);
    EXPECT_EQ(floats(weave(mesh, WeavePattern::Satin5), 20, 20), 4);
}

TEST(WeaveCells, PutsOneCrossingOfEverySatinRowAndColumnOnTop) {
    const auto mesh = test::flat_grid({5, 5}, 10.0);
    const Weave result = weave(mesh, WeavePattern::Satin5);
    for (std::size_t i = 0; i < 5; ++i) {
        int row = 0;
        int col = 0;
        for (std::size_t j = 0; j < 5; ++j) {
            row += result.warp_on_top[5 * i + j];
            col += result.warp_on_top[5 * j + i];
        }
        EXPECT_EQ(row, 1);
        EXPECT_EQ(col, 1);
    }
}

TEST(WeaveCells, RepeatsAUserMatrix) {
    WeaveParams params;
    params.pattern = WeavePattern::Matrix;
    params.matrix = {{1, 0, 0}, {0, 0, 1}};
    const Weave result = weave_cells(test::flat_grid({3, 4}, 10.0), params);
    EXPECT_EQ(result.warp_on_top, (std::vector<std::uint8_t>{1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1}));
}

}  // namespace
}  // namespace leafcutter::fab
