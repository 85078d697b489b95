#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "fab/cut/cut_order.h"
#include "fab/cut/point_grid.h"
#include "fab/nest/collision.h"

namespace leafcutter::fab {
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

// Long bent bands on shelves, each starting at any of its points.
std::vector<CutPath> shuffled_bands(int count, std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto between = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
    };
    std::vector<CutPath> paths;
    Eigen::Vector2d corner(5.0, 5.0);
    constexpr int kCells = 24;
    for (int i = 0; i < count; ++i) {
        const double length = between(80.0, 480.0);
        const double width = between(5.0, 14.0);
        const double turn = between(-1.0, 1.0);
        if (corner.x() + length > 1200.0) {
            corner = {5.0, corner.y() + 18.0};
        }
        CutPath path;
        Polyline back;
        Eigen::Vector2d at = corner;
        for (int k = 0; k <= kCells; ++k) {
            const double heading = turn * (static_cast<double>(k) / kCells - 0.5);
            const Eigen::Vector2d side(-std::sin(heading), std::cos(heading));
            path.points.push_back(at - side * width / 2.0);
            back.push_back(at + side * width / 2.0);
            at += length / kCells * Eigen::Vector2d(std::cos(heading), std::sin(heading));
        }
        path.points.insert(path.points.end(), back.rbegin(), back.rend());
        std::rotate(path.points.begin(), path.points.begin() + random() % 50, path.points.end());
        path.points.push_back(path.points.front());
        paths.push_back(path);
        corner.x() += length + 5.0;
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

double nearest_neighbour_with_fixed_starts(std::vector<CutPath> paths) {
    double sum = 0.0;
    Eigen::Vector2d at = kHome;
    while (!paths.empty()) {
        const auto next =
            std::min_element(paths.begin(), paths.end(), [&](const CutPath& a, const CutPath& b) {
                return (a.points.front() - at).norm() < (b.points.front() - at).norm();
            });
        sum += (next->points.front() - at).norm();
        at = next->points.back();
        paths.erase(next);
    }
    return sum;
}

TEST(CutOrder, KeepsEveryPathOnceAndClosed) {
    const std::vector<CutPath> paths = shuffled_rectangles(60, 2);
    const std::vector<CutPath> ordered = order_paths(paths, kHome);
    EXPECT_EQ(fingerprint(ordered), fingerprint(paths));
    for (const CutPath& path : ordered) {
        EXPECT_EQ(path.points.front(), path.points.back());
        EXPECT_EQ(path.points.size(), 5U);
    }
}

TEST(CutOrder, TravelsFarLessThanNearestNeighbourWithFixedStarts) {
    const std::vector<CutPath> paths = shuffled_bands(200, 7);
    const double travel = travel_mm(order_paths(paths, kHome), kHome);
    EXPECT_LT(travel, 0.65 * nearest_neighbour_with_fixed_starts(paths));
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
