// Sheets full of contours for tests and benchmarks of the cut planner.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "fab/cut/cut_program.h"

namespace leafcutter::fab::test {

// Long bent bands on shelves, shuffled, each starting at any of its points.
inline std::vector<CutPath> shuffled_bands(int count, std::uint32_t seed) {
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

// What most programs do: to the nearest start next, each path as it is drawn.
inline double nearest_neighbour_with_fixed_starts(std::vector<CutPath> paths) {
    double sum = 0.0;
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    while (!paths.empty()) {
        const auto next =
            std::min_element(paths.begin(), paths.end(), [&](const CutPath& a, const CutPath& b) {
                return (a.points.front() - at).squaredNorm() <
                       (b.points.front() - at).squaredNorm();
            });
        sum += (next->points.front() - at).norm();
        at = next->points.back();
        std::swap(*next, paths.back());
        paths.pop_back();
    }
    return sum;
}

}  // namespace leafcutter::fab::test
