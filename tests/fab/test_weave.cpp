#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "fab/weave/weave.h"
#include "geometry/error.h"
#include "geometry/foliation.h"
#include "geometry/quads/quad_edges.h"
#include "geometry/quads/threads.h"
#include "geometry/samples.h"
#include "geometry/surface_measures.h"
#include "tests/geometry/surfaces.h"
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

constexpr std::array kPatterns{WeavePattern::Plain,      WeavePattern::Twill2x2,
                               WeavePattern::DoubleWarp, WeavePattern::DoubleWeft,
                               WeavePattern::Satin5,     WeavePattern::Basket2x2};

struct Sample {
    double area = 0.0;
    geometry::Foliation foliation;

    explicit Sample(std::string_view name) {
        const geometry::TriangleMesh triangles = geometry::make_sample(name, 2500);
        area = geometry::surface_area(triangles);
        foliation = geometry::compute_foliation(testing::to_mesh(triangles));
    }

    geometry::QuadMesh grid(double cells, int period) const {
        geometry::GridOptions options;
        options.strip_width_mm = std::sqrt(area / cells);
        options.period = period;
        return geometry::build_quad_mesh(foliation, options);
    }
};

// Counted apart from the code under test: every thread walked out cell by cell.
std::vector<int> runs(const geometry::QuadMesh& mesh,
                      const std::vector<std::uint8_t>& top,
                      Family family) {
    std::vector<int> found;
    for (const auto& thread :
         geometry::trace_threads(mesh, family, geometry::ThreadEnds::Through)) {
        std::vector<int> sides;
        for (const int quad : thread.quads) {
            sides.push_back(top[static_cast<std::size_t>(quad)]);
        }
        if (thread.closed) {
            const auto change =
                std::adjacent_find(sides.begin(), sides.end(), std::not_equal_to<>());
            if (change != sides.end()) {
                std::rotate(sides.begin(), change + 1, sides.end());
            }
        }
        int length = 0;
        for (std::size_t i = 0; i < sides.size(); ++i) {
            ++length;
            if (i + 1 == sides.size() || sides[i + 1] != sides[i]) {
                found.push_back(length);
                length = 0;
            }
        }
    }
    return found;
}

void expect_told_truly(const geometry::QuadMesh& mesh, const Weave& weave) {
    const Floats& floats = weave.floats;
    std::vector<std::uint8_t> unflipped = weave.warp_on_top;
    for (const int quad : floats.flips) {
        unflipped[static_cast<std::size_t>(quad)] ^= 1U;
    }
    std::size_t left = 0;
    const auto compare = [&](const std::vector<std::uint8_t>& top, Family family,
                             const FamilyFloats& told) {
        const std::vector<int> lengths = runs(mesh, top, family);
        EXPECT_EQ(told.longest, *std::max_element(lengths.begin(), lengths.end()));
        EXPECT_NEAR(
            told.mean,
            double(std::accumulate(lengths.begin(), lengths.end(), 0)) / double(lengths.size()),
            1e-12);
        EXPECT_EQ(told.over_limit, floats.limit
                                       ? std::count_if(lengths.begin(), lengths.end(),
                                                       [&](int l) { return l > *floats.limit; })
                                       : 0);
        return static_cast<std::size_t>(told.over_limit);
    };
    compare(unflipped, Family::Weft, floats.weft_before);
    compare(unflipped, Family::Warp, floats.warp_before);
    left += compare(weave.warp_on_top, Family::Weft, floats.weft);
    left += compare(weave.warp_on_top, Family::Warp, floats.warp);
    EXPECT_EQ(left, floats.too_long.size());
    EXPECT_LE(floats.weft.longest,
              std::max(floats.limit.value_or(1 << 20), floats.weft_before.longest));
    EXPECT_LE(floats.warp.longest,
              std::max(floats.limit.value_or(1 << 20), floats.warp_before.longest));
}

TEST(Floats, AreLimitedToOneMoreThanThePatternHas) {
    const std::array expected{std::optional(2),     std::optional(3), std::optional<int>(),
                              std::optional<int>(), std::optional(5), std::optional(3)};
    for (std::size_t i = 0; i < kPatterns.size(); ++i) {
        WeaveParams params;
        params.pattern = kPatterns[i];
        EXPECT_EQ(float_limit(params), expected[i]);
        params.max_float = 9;
        EXPECT_EQ(float_limit(params), 9);
    }
}

TEST(Floats, RefuseALimitThatThePatternItselfBreaks) {
    WeaveParams params;
    params.pattern = WeavePattern::Satin5;
    params.max_float = 3;
    try {
        float_limit(params);
        FAIL();
    } catch (const geometry::Error& error) {
        EXPECT_EQ(error.kind(), geometry::ErrorKind::BadOption);
        EXPECT_NE(std::string(error.what()).find("weave.max_float: must be at least 4"),
                  std::string::npos);
    }
}

TEST(Floats, OfAWholePatternNeedNoFlip) {
    for (const WeavePattern pattern : kPatterns) {
        const auto mesh = test::torus_grid({20, 20}, 50.0, 15.0);
        const Weave result = weave(mesh, pattern);
        EXPECT_TRUE(result.floats.flips.empty());
        expect_told_truly(mesh, result);
    }
}

TEST(Floats, AreBrokenAtTheSeamOfATwill) {
    // Ten columns are two and a half repeats: 1 1 of the end meets 1 1 of the beginning.
    const auto mesh = test::cylinder_grid({12, 10}, 50.0, 60.0);
    const Weave result = weave(mesh, WeavePattern::Twill2x2);
    expect_told_truly(mesh, result);
    EXPECT_EQ(result.floats.weft_before.longest, 4);
    EXPECT_EQ(result.floats.weft_before.over_limit, 6);  // Every other row; the others end inside.
    EXPECT_LE(result.floats.weft.longest, 3);
    EXPECT_LE(result.floats.warp.longest, 3);
    EXPECT_GT(result.floats.flips.size(), 0U);
}

TEST(Floats, TieTwoLayersTogetherIfAsked) {
    WeaveParams params;
    params.pattern = WeavePattern::DoubleWarp;
    params.max_float = 6;
    const auto mesh = test::cylinder_grid({30, 40}, 50.0, 60.0);
    const Weave result = weave_cells(mesh, params);
    expect_told_truly(mesh, result);
    EXPECT_TRUE(result.floats.too_long.empty());
    EXPECT_LE(result.floats.weft.longest, 6);
    EXPECT_LE(result.floats.warp.longest, 6);
    EXPECT_LE(result.floats.flips.size(), 30U * 40U / 4U);
}

TEST(Floats, OfAnyWeaveNeverGrowAboveTheLimit) {
    std::mt19937 random(3);
    for (int round = 0; round < 40; ++round) {
        WeaveParams params;
        params.pattern = WeavePattern::Matrix;
        params.matrix.assign(1 + random() % 5, std::vector<int>(1 + random() % 5));
        for (auto& row : params.matrix) {
            for (int& entry : row) {
                entry = static_cast<int>(random() % 2);
            }
        }
        params.max_float = 5 + static_cast<int>(random() % 3);
        const test::GridSize size{5 + static_cast<int>(random() % 12),
                                  5 + static_cast<int>(random() % 12)};
        const auto mesh =
            round % 2 == 0 ? test::torus_grid(size, 50.0, 15.0) : test::flat_grid(size, 10.0);
        const Weave result = weave_cells(mesh, params);
        expect_told_truly(mesh, result);
    }
}

TEST(Floats, StayShortWhereCylindersMeet) {
    for (const char* name : {"eight", "hand"}) {
        const Sample sample(name);
        for (const WeavePattern pattern : kPatterns) {
            SCOPED_TRACE(name);
            WeaveParams params;
            params.pattern = pattern;
            const auto mesh = sample.grid(600.0, std::max(2, pattern_period(params)));
            const Weave result = weave_cells(mesh, params);
            expect_told_truly(mesh, result);
            EXPECT_TRUE(result.floats.too_long.empty());
        }
    }
}

TEST(WeaveCells, LeavesTheShapeAlone) {
    // With fixed counts the pattern's period has no say.
    const Sample sample("eight");
    std::optional<geometry::QuadMesh> first;
    for (const WeavePattern pattern : kPatterns) {
        WeaveParams params;
        params.pattern = pattern;
        geometry::GridOptions options;
        options.junctions = geometry::Junctions::Independent;
        options.all = {.rows = 12, .cols = 20};
        options.period = std::max(2, pattern_period(params));
        const geometry::QuadMesh mesh = geometry::build_quad_mesh(sample.foliation, options);
        if (!first) {
            first = mesh;
        }
        EXPECT_EQ(mesh.quads, first->quads);
        EXPECT_EQ(mesh.vertices, first->vertices);
    }
}

// Of a 2 x 2 block of cells in a twill: the corners that are alike lie on its diagonal.
TEST(WeaveCells, TwillRunsTheSameWayInAllCylinders) {
    const auto mesh = Sample("eight").grid(1200.0, 4);
    const Weave result = weave(mesh, WeavePattern::Twill2x2);
    const auto neighbours = geometry::find_neighbours(mesh.quads);
    const auto top = [&](int quad) { return result.warp_on_top[static_cast<std::size_t>(quad)]; };
    // Behind a side, and then to the right of where one came from: turning with the surface, not
    // with the charts. Diagonals of one hand stay alike.
    int alike = 0;
    int other = 0;
    for (int quad = 0; quad < static_cast<int>(mesh.quads.size()); ++quad) {
        for (const std::size_t side : {1U, 2U, 3U, 0U}) {
            const auto& ahead = neighbours.across[static_cast<std::size_t>(quad)][side];
            if (ahead.quad < 0) {
                continue;
            }
            const auto step = [&](int turn) {
                return neighbours.across[static_cast<std::size_t>(ahead.quad)]
                                        [static_cast<std::size_t>((ahead.side + 2 + turn) % 4)];
            };
            const bool weft_step = side % 2 == 1;
            const auto up = step(weft_step ? 1 : 3);
            const auto down = step(weft_step ? 3 : 1);
            if (up.quad >= 0 && down.quad >= 0) {
                alike += top(quad) == top(up.quad) ? 1 : 0;
                other += top(quad) == top(down.quad) ? 1 : 0;
            }
        }
    }
    // A twill of either hand: one diagonal always alike, the other one half the time... never
    // mixed.
    const int most = std::max(alike, other);
    const int least = std::min(alike, other);
    EXPECT_GT(most, 19 * static_cast<int>(mesh.quads.size()) / 5);
    EXPECT_LT(least, static_cast<int>(mesh.quads.size()) / 5);
}

TEST(WeaveCells, TurnsAPatternWhereChartsMeetHeadOn) {
    // A sheet whose upper half is a chart of its own, turned by half.
    constexpr int kRows = 7;
    constexpr int kCols = 9;
    geometry::QuadMesh mesh = test::flat_grid({2 * kRows, kCols}, 10.0);
    const auto half = static_cast<std::ptrdiff_t>(kRows * kCols);
    std::reverse(mesh.quads.begin() + half, mesh.quads.end());
    for (std::size_t i = static_cast<std::size_t>(half); i < mesh.quads.size(); ++i) {
        std::rotate(mesh.quads[i].begin(), mesh.quads[i].begin() + 2, mesh.quads[i].end());
        mesh.addresses[i].cylinder = 1;
        mesh.addresses[i].row -= kRows;
    }
    WeaveParams params;
    params.pattern = WeavePattern::Matrix;
    params.matrix = {{1, 0, 0, 0}, {1, 1, 0, 0}, {0, 1, 1, 0}};  // Not the same upside down.
    const Weave result = weave_cells(mesh, params);
    EXPECT_TRUE(result.seams.empty());
    EXPECT_TRUE(result.shortest);
}

}  // namespace
}  // namespace leafcutter::fab
