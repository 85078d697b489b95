#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "geometry/quads/threads.h"
#include "tests/geometry/charts.h"

namespace leafcutter::geometry {
namespace {

QuadMesh grid_of(const Foliation& foliation, int rows, int cols) {
    GridOptions options;
    options.all = {.rows = rows, .cols = cols};
    options.parity = Parity::Any;
    options.half_sag_offset = false;
    return build_quad_mesh(foliation, options);
}

enum class Joined { Across, Along };  // In g, or in f.

// Two flat grids of `rows` x `cols` cells, joined along their common vertices.
QuadMesh two_joined_cylinders(int rows, int cols, Joined joined = Joined::Across) {
    QuadMesh mesh;
    const bool across = joined == Joined::Across;
    const int width = across ? 2 * cols : cols;
    const int height = across ? rows : 2 * rows;
    const auto vertex = [&](int i, int j) { return i * (width + 1) + j; };
    for (int i = 0; i <= height; ++i) {
        for (int j = 0; j <= width; ++j) {
            mesh.vertices.emplace_back(j, i, 0);
        }
    }
    for (int cylinder = 0; cylinder < 2; ++cylinder) {
        for (int i = 0; i < rows; ++i) {
            for (int j = 0; j < cols; ++j) {
                const int k = j + (across ? cylinder * cols : 0);
                const int l = i + (across ? 0 : cylinder * rows);
                mesh.quads.push_back(
                    {vertex(l, k), vertex(l, k + 1), vertex(l + 1, k + 1), vertex(l + 1, k)});
                mesh.addresses.push_back({.cylinder = cylinder, .row = i, .col = j});
                mesh.surface_area.push_back(1.0);
            }
        }
        mesh.grids.emplace_back();
    }
    return mesh;
}

void expect_partition(const QuadMesh& mesh, const std::vector<Thread>& threads) {
    std::vector<int> seen;
    int last_smallest = -1;
    for (const Thread& thread : threads) {
        seen.insert(seen.end(), thread.quads.begin(), thread.quads.end());
        const int smallest = *std::min_element(thread.quads.begin(), thread.quads.end());
        EXPECT_GT(smallest, last_smallest);
        last_smallest = smallest;
    }
    std::sort(seen.begin(), seen.end());
    std::vector<int> all(mesh.quads.size());
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(seen, all);
}

TEST(Threads, RunAlongRowsAndColumnsOfARectangle) {
    const QuadMesh mesh = grid_of(testing::flat_rectangle(3.0, 2.0), 2, 3);
    const auto weft = trace_threads(mesh, Family::Weft, ThreadEnds::AtCriticalLeaves);
    ASSERT_EQ(weft.size(), 2U);
    EXPECT_EQ(weft[0].quads, (std::vector<int>{0, 1, 2}));
    EXPECT_EQ(weft[1].quads, (std::vector<int>{3, 4, 5}));
    EXPECT_FALSE(weft[0].closed);
    const auto warp = trace_threads(mesh, Family::Warp, ThreadEnds::AtCriticalLeaves);
    ASSERT_EQ(warp.size(), 3U);
    EXPECT_EQ(warp[1].quads, (std::vector<int>{1, 4}));
    EXPECT_FALSE(warp[1].closed);
}

TEST(Threads, CloseAroundACylinder) {
    const QuadMesh mesh = grid_of(testing::round_cylinder(10.0, 30.0), 3, 5);
    const auto weft = trace_threads(mesh, Family::Weft, ThreadEnds::AtCriticalLeaves);
    ASSERT_EQ(weft.size(), 3U);
    for (const Thread& ring : weft) {
        EXPECT_TRUE(ring.closed);
        EXPECT_EQ(ring.quads.size(), 5U);
    }
    const auto warp = trace_threads(mesh, Family::Warp, ThreadEnds::AtCriticalLeaves);
    EXPECT_EQ(warp.size(), 5U);
    EXPECT_FALSE(warp[0].closed);
    expect_partition(mesh, weft);
    expect_partition(mesh, warp);
}

TEST(Threads, OfATwistedTorusCloseAfterTheGreatestCommonDivisor) {
    // A shear of 0.26 widths is 2.08, so 2, of 8 columns: warp threads close after 8 / gcd(8, 2).
    const QuadMesh mesh = grid_of(testing::slanted_torus(10.0, 40.0, 2.6), 6, 8);
    ASSERT_EQ(std::abs(mesh.grids[0].column_shift), 2);
    const auto weft = trace_threads(mesh, Family::Weft, ThreadEnds::AtCriticalLeaves);
    ASSERT_EQ(weft.size(), 6U);
    EXPECT_TRUE(weft[0].closed);
    const auto warp = trace_threads(mesh, Family::Warp, ThreadEnds::AtCriticalLeaves);
    ASSERT_EQ(warp.size(), 2U);
    for (const Thread& thread : warp) {
        EXPECT_TRUE(thread.closed);
        EXPECT_EQ(thread.quads.size(), 24U);
    }
    expect_partition(mesh, weft);
    expect_partition(mesh, warp);
}

TEST(Threads, OfWarpEndAtCriticalLeavesOnlyIfAsked) {
    const QuadMesh mesh = two_joined_cylinders(2, 3, Joined::Along);
    const auto cut = trace_threads(mesh, Family::Warp, ThreadEnds::AtCriticalLeaves);
    ASSERT_EQ(cut.size(), 6U);
    EXPECT_EQ(cut[0].quads, (std::vector<int>{0, 3}));
    EXPECT_EQ(cut[0].next, 6);
    expect_partition(mesh, cut);
    const auto through = trace_threads(mesh, Family::Warp, ThreadEnds::Through);
    ASSERT_EQ(through.size(), 3U);
    EXPECT_EQ(through[0].quads, (std::vector<int>{0, 3, 6, 9}));
    expect_partition(mesh, through);
}

TEST(Threads, OfWeftGoOnAcrossLeavesThatTheyCross) {
    const QuadMesh mesh = two_joined_cylinders(2, 3);
    const auto weft = trace_threads(mesh, Family::Weft, ThreadEnds::AtCriticalLeaves);
    ASSERT_EQ(weft.size(), 2U);
    EXPECT_EQ(weft[0].quads, (std::vector<int>{0, 1, 2, 6, 7, 8}));
    expect_partition(mesh, weft);
}

TEST(Threads, StartAtTheBackEndWhateverQuadComesFirst) {
    QuadMesh mesh = two_joined_cylinders(1, 2);
    std::swap(mesh.quads[0], mesh.quads[3]);
    const auto threads = trace_threads(mesh, Family::Weft, ThreadEnds::Through);
    ASSERT_EQ(threads.size(), 1U);
    EXPECT_EQ(threads[0].quads, (std::vector<int>{3, 1, 2, 0}));
}

}  // namespace
}  // namespace leafcutter::geometry
