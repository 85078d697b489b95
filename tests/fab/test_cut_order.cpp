#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fab/cut/cut_order.h"
#include "fab/cut/path_walk.h"
#include "fab/cut/point_grid.h"
#include "geometry/plane.h"
#include "tests/support/cut_sheets.h"

namespace leafcutter::fab {

using geometry::signed_area;

namespace {

const Eigen::Vector2d kHome = Eigen::Vector2d::Zero();

CutPath rectangle(double x, double y, double width, double height) {
    CutPath path;
    path.points = {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}, {x, y}};
    return path;
}

std::vector<CutPath> shuffled_rectangles(int count, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<CutPath> paths;
    for (int i = 0; i < count; ++i) {
        paths.push_back(rectangle(12.0 * (i % 20), 9.0 * static_cast<double>(i / 20), 10.0, 7.0));
        paths.back().piece = std::to_string(i);
    }
    std::shuffle(paths.begin(), paths.end(), random);
    return paths;
}

// Each path as a set of points, so that start and direction don't matter.
std::vector<std::vector<std::pair<double, double>>> fingerprint(const std::vector<CutPath>& paths) {
    std::vector<std::vector<std::pair<double, double>>> out;
    for (const CutPath& path : paths) {
        std::vector<std::pair<double, double>> points;
        for (const Eigen::Vector2d& point : path.points) {
            points.emplace_back(point.x(), point.y());
        }
        std::sort(points.begin(), points.end());
        points.erase(std::unique(points.begin(), points.end()), points.end());
        out.push_back(points);
    }
    std::sort(out.begin(), out.end());
    return out;
}

TEST(CutOrder, KeepsEveryPathOnceAndClosed) {
    const std::vector<CutPath> paths = shuffled_rectangles(60, 2);
    const std::vector<CutPath> ordered = order_paths(paths, kHome);
    ASSERT_EQ(ordered.size(), paths.size());
    std::set<std::string> seen;
    for (const CutPath& path : ordered) {
        EXPECT_EQ(path.points.front(), path.points.back());
        EXPECT_NEAR(length_mm(path.points), 34.0, 1e-9);
        EXPECT_NEAR(std::abs(signed_area(path.points)), 70.0, 1e-9);
        EXPECT_TRUE(seen.insert(path.piece).second);
    }
}

TEST(CutOrder, TravelsFarLessThanNearestNeighbourWithFixedStarts) {
    for (const std::uint32_t seed : {7U, 8U}) {
        const std::vector<CutPath> paths = test::shuffled_bands(600, seed);
        const double travel = travel_mm(order_paths(paths, kHome), kHome);
        EXPECT_LT(travel, 0.5 * test::nearest_neighbour_with_fixed_starts(paths));
    }
}

TEST(CutOrder, KeepsToldPrecedenceHoweverLongTheWay) {
    std::vector<CutPath> paths = shuffled_rectangles(80, 4);
    OrderRules rules;
    std::mt19937 random(11);
    for (std::size_t i = 0; i + 1 < paths.size(); ++i) {
        // Forward only: no ring.
        rules.before.emplace_back(i, i + 1 + random() % (paths.size() - i - 1));
    }
    const std::vector<CutPath> ordered = order_paths(paths, kHome, rules);
    std::map<std::string, std::size_t> position;
    for (const CutPath& path : ordered) {
        position.emplace(path.piece, position.size());
    }
    ASSERT_EQ(position.size(), paths.size());
    for (const auto& [first, second] : rules.before) {
        EXPECT_LT(position.at(paths[first].piece), position.at(paths[second].piece));
    }
}

TEST(CutOrder, StartsOnlyWhereItIsTold) {
    const std::vector<CutPath> paths = shuffled_rectangles(30, 5);
    OrderRules rules;
    rules.starts_mm.assign(paths.size(), {4.0, 13.5});
    for (const CutPath& path : order_paths(paths, kHome, rules)) {
        const auto drawn = std::find_if(paths.begin(), paths.end(), [&](const CutPath& each) {
            return each.piece == path.piece;
        });
        const Eigen::Vector2d corner = drawn->points.front();
        const Eigen::Vector2d start = path.points.front() - corner;
        EXPECT_TRUE((start - Eigen::Vector2d(4.0, 0.0)).norm() < 1e-9 ||
                    (start - Eigen::Vector2d(10.0, 3.5)).norm() < 1e-9)
            << start.transpose();
    }
}

TEST(CutOrder, CutsTheInsideBeforeItsOutside) {
    std::vector<CutPath> paths{rectangle(10.0, 10.0, 200.0, 100.0),
                               rectangle(20.0, 20.0, 50.0, 50.0), rectangle(30.0, 30.0, 5.0, 5.0),
                               rectangle(300.0, 10.0, 20.0, 20.0),
                               rectangle(100.0, 20.0, 20.0, 20.0)};
    for (std::size_t i = 0; i < paths.size(); ++i) {
        paths[i].piece = std::to_string(i);
    }
    const std::vector<CutPath> ordered = order_paths(paths, kHome);
    const auto position = [&](const char* piece) {
        return std::find_if(ordered.begin(), ordered.end(),
                            [&](const CutPath& path) { return path.piece == piece; }) -
               ordered.begin();
    };
    EXPECT_LT(position("2"), position("1"));
    EXPECT_LT(position("1"), position("0"));
    EXPECT_LT(position("4"), position("0"));
}

TEST(CutOrder, RunsAnOpenZigzagBackAndForth) {
    std::vector<CutPath> lines;
    for (int i = 0; i < 12; ++i) {
        CutPath line;
        line.points = {{0.0, 2.0 * i}, {100.0, 2.0 * i}};
        lines.push_back(line);
    }
    EXPECT_NEAR(travel_mm(order_paths(lines, kHome), kHome), 22.0, 1e-9);
}

TEST(CutOrder, IsNeverLongerThanTheOrderOfRandomStrokesBefore) {
    std::mt19937 random(3);
    const auto roll = [&] { return 300.0 * static_cast<double>(random()) / 4294967296.0; };
    std::vector<CutPath> strokes;
    for (int i = 0; i < 400; ++i) {
        CutPath stroke;
        const Eigen::Vector2d at(roll(), roll());
        stroke.points = {at, at + Eigen::Vector2d(3.0, 1.0), at + Eigen::Vector2d(0.0, 4.0)};
        strokes.push_back(stroke);
    }
    const std::vector<CutPath> once = order_paths(strokes, kHome);
    EXPECT_EQ(fingerprint(once), fingerprint(strokes));
    // A random tour of 400 stops on this square is some 60 m; a good one about 0.7 √(n·area) = 4.2
    // m.
    EXPECT_LT(travel_mm(once, kHome), 5500.0);
}

TEST(CutOrder, OfNothingIsNothing) {
    EXPECT_TRUE(order_paths({}, kHome).empty());
}

TEST(PointGrid, FindsTheNearestAsALinearSearchDoes) {
    std::mt19937 random(9);
    const auto roll = [&] { return static_cast<double>(random()) / 42949672.96; };
    std::vector<Eigen::Vector2d> points;
    for (int i = 0; i < 500; ++i) {
        points.emplace_back(roll() * roll(), roll());
    }
    PointGrid grid(points);
    std::vector<bool> gone(points.size(), false);
    for (std::size_t query = 0; query < 490; ++query) {
        const Eigen::Vector2d to(roll() * 2.0 - 50.0, roll() * 2.0 - 50.0);
        double expected = 1e9;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!gone[i]) {
                expected = std::min(expected, (points[i] - to).norm());
            }
        }
        const std::size_t found = grid.nearest(to);
        EXPECT_FALSE(gone[found]);
        EXPECT_NEAR((points[found] - to).norm(), expected, 1e-12);
        grid.remove(found);
        gone[found] = true;
    }
}

}  // namespace
}  // namespace leafcutter::fab
