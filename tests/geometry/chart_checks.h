// What must hold for every cylinder, judged from its public fields alone.

#pragma once

#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "geometry/foliation.h"

namespace leafcutter::testing {

// Every triangle positive, areas adding up to the chart, lifts equal across edges up to a period.
inline ::testing::AssertionResult is_sound(const geometry::Cylinder& chart) {
    using Corners = std::pair<Eigen::Vector2d, Eigen::Vector2d>;
    const auto& triangles = chart.mesh.triangles;
    if (triangles.empty() || chart.corner_gf.size() != triangles.size() ||
        chart.source_vertex.size() != chart.mesh.positions.size()) {
        return ::testing::AssertionFailure() << "sizes differ";
    }
    std::map<std::pair<int, int>, Corners> sides;
    double area = 0.0;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto& gf = chart.corner_gf[t];
        const Eigen::Vector2d a = gf[1] - gf[0];
        const Eigen::Vector2d b = gf[2] - gf[0];
        const double doubled = a.x() * b.y() - a.y() * b.x();
        if (!(doubled > 0.0)) {
            return ::testing::AssertionFailure() << "triangle " << t << " has area " << doubled / 2;
        }
        area += doubled / 2;
        for (std::size_t k = 0; k < 3; ++k) {
            sides[{triangles[t][k], triangles[t][(k + 1) % 3]}] = {gf[k], gf[(k + 1) % 3]};
        }
    }
    if (std::abs(area / (chart.width * chart.height) - 1.0) > 1e-9) {
        return ::testing::AssertionFailure()
               << "covers " << area << " of " << chart.width * chart.height;
    }
    for (const auto& [ends, corners] : sides) {
        const auto twin = sides.find({ends.second, ends.first});
        if (twin == sides.end()) {
            continue;
        }
        const Eigen::Vector2d here = corners.first - twin->second.second;
        const Eigen::Vector2d there = corners.second - twin->second.first;
        const double rows =
            chart.shape == geometry::ChartShape::Torus ? here.y() / chart.height : 0.0;
        const double columns = chart.shape == geometry::ChartShape::Rectangle
                                   ? 0.0
                                   : (here.x() - std::round(rows) * chart.shear) / chart.width;
        const Eigen::Vector2d period(
            std::round(columns) * chart.width + std::round(rows) * chart.shear,
            std::round(rows) * chart.height);
        const double tolerance = 1e-9 * (chart.width + chart.height);
        if ((here - there).norm() > tolerance || (here - period).norm() > tolerance) {
            return ::testing::AssertionFailure() << "edge " << ends.first << "-" << ends.second
                                                 << " is torn by " << here.transpose();
        }
    }
    return ::testing::AssertionSuccess();
}

// One lift of each vertex.
inline std::vector<Eigen::Vector2d> vertex_gf(const geometry::Cylinder& chart) {
    std::vector<Eigen::Vector2d> out(chart.mesh.positions.size());
    for (std::size_t t = 0; t < chart.mesh.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            out[static_cast<std::size_t>(chart.mesh.triangles[t][k])] = chart.corner_gf[t][k];
        }
    }
    return out;
}

}  // namespace leafcutter::testing
