// Charts by formula, for tests that need a foliation but no solver.

#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "geometry/foliation.h"

namespace leafcutter::testing {

using geometry::ChartShape;
using geometry::Cylinder;
using geometry::Foliation;

struct ChartForm {
    ChartShape shape = ChartShape::Rectangle;
    int across = 20;  // Vertex columns, in g.
    int along = 20;   // Vertex rows, in f.
    double width = 1.0;
    double height = 1.0;
    double shear = 0.0;
    // Both from fractions (u, v) in [0, 1] of the chart.
    std::function<Eigen::Vector3d(double, double)> position = {};
    std::function<Eigen::Vector2d(double, double)> gf =
        {};  // Default: (width u + shear v, height v).
};

inline Cylinder make_chart(const ChartForm& form) {
    const bool ring = form.shape != ChartShape::Rectangle;
    const bool torus = form.shape == ChartShape::Torus;
    const int cols = form.across + (ring ? 0 : 1);
    const int rows = form.along + (torus ? 0 : 1);
    const auto fraction = [&form](int i, int j) {
        return std::pair{static_cast<double>(i) / form.across, static_cast<double>(j) / form.along};
    };
    const auto vertex = [&](int i, int j) { return (j % rows) * cols + i % cols; };
    const auto lifted = [&](int i, int j) -> Eigen::Vector2d {
        const auto [u, v] = fraction(i, j);
        return form.gf ? form.gf(u, v)
                       : Eigen::Vector2d(form.width * u + form.shear * v, form.height * v);
    };
    Cylinder chart;
    chart.shape = form.shape;
    chart.width = form.width;
    chart.height = form.height;
    chart.shear = form.shear;
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < cols; ++i) {
            const auto [u, v] = fraction(i, j);
            chart.mesh.positions.push_back(form.position(u, v));
            chart.source_vertex.push_back(vertex(i, j));
        }
    }
    for (int j = 0; j < form.along; ++j) {
        for (int i = 0; i < form.across; ++i) {
            // Diagonals alternate, so that no direction is favoured.
            const std::pair<int, int> a{i, j};
            const std::pair<int, int> b{i + 1, j};
            const std::pair<int, int> c{i + 1, j + 1};
            const std::pair<int, int> d{i, j + 1};
            const auto add = [&](auto p, auto q, auto r) {
                chart.mesh.triangles.push_back({vertex(p.first, p.second),
                                                vertex(q.first, q.second),
                                                vertex(r.first, r.second)});
                chart.corner_gf.push_back({lifted(p.first, p.second), lifted(q.first, q.second),
                                           lifted(r.first, r.second)});
            };
            if ((i + j) % 2 == 0) {
                add(a, b, c);
                add(a, c, d);
            } else {
                add(a, b, d);
                add(b, c, d);
            }
        }
    }
    return chart;
}

inline Foliation one_cylinder(Cylinder chart) {
    Foliation foliation;
    foliation.graph.nodes = 2;
    foliation.graph.edges.push_back({.from = 0, .to = 1, .weight = chart.height});
    foliation.cylinders.push_back(std::move(chart));
    return foliation;
}

// A flat rectangle in the plane z = 0.
inline Foliation flat_rectangle(double width, double height, int across = 20, int along = 20) {
    return one_cylinder(make_chart({.shape = ChartShape::Rectangle,
                                    .across = across,
                                    .along = along,
                                    .width = width,
                                    .height = height,
                                    .position = [=](double u, double v) {
                                        return Eigen::Vector3d(width * u, height * v, 0);
                                    }}));
}

// An open round cylinder about the z axis, seen from outside.
inline Foliation round_cylinder(double radius, double length, int across = 96, int along = 16) {
    const double turn = 2.0 * std::numbers::pi;
    return one_cylinder(make_chart({.shape = ChartShape::Annulus,
                                    .across = across,
                                    .along = along,
                                    .width = turn * radius,
                                    .height = length,
                                    .position = [=](double u, double v) {
                                        return Eigen::Vector3d(radius * std::cos(turn * u),
                                                               radius * std::sin(turn * u),
                                                               length * v);
                                    }}));
}

// The round torus with its exact conformal coordinates; rings of F run around the tube.
inline Foliation round_torus(double big, double small, int across = 48, int along = 128) {
    const double turn = 2.0 * std::numbers::pi;
    const double root = std::sqrt(big * big - small * small);
    const auto conformal = [=](double u) {
        // Integral of r dt / (R + r cos t) from -pi, in closed form.
        const double angle = turn * u - std::numbers::pi;
        const double half =
            std::atan(std::sqrt((big - small) / (big + small)) * std::tan(0.5 * angle));
        const double clean = u <= 0.0   ? -0.5 * std::numbers::pi
                             : u >= 1.0 ? 0.5 * std::numbers::pi
                                        : half;
        return 2.0 * small / root * (clean + 0.5 * std::numbers::pi);
    };
    return one_cylinder(make_chart(
        {.shape = ChartShape::Torus,
         .across = across,
         .along = along,
         .width = turn * small / root,
         .height = turn,
         .position =
             [=](double u, double v) {
                 const double tube = turn * u - std::numbers::pi;
                 const double reach = big + small * std::cos(tube);
                 return Eigen::Vector3d(reach * std::cos(turn * v), reach * std::sin(turn * v),
                                        -small * std::sin(tube));
             },
         .gf = [=](double u, double v) { return Eigen::Vector2d(conformal(u), turn * v); }}));
}

// A torus whose chart is slanted by `shear`, on the shape of the round torus (not conformal).
inline Foliation slanted_torus(double width, double height, double shear) {
    const double turn = 2.0 * std::numbers::pi;
    return one_cylinder(make_chart({.shape = ChartShape::Torus,
                                    .across = 24,
                                    .along = 64,
                                    .width = width,
                                    .height = height,
                                    .shear = shear,
                                    .position = [=](double u, double v) {
                                        const double reach = 100.0 + 25.0 * std::cos(turn * u);
                                        return Eigen::Vector3d(reach * std::cos(turn * v),
                                                               reach * std::sin(turn * v),
                                                               -25.0 * std::sin(turn * u));
                                    }}));
}

inline double area_of(const geometry::TriangleMesh& mesh) {
    double sum = 0.0;
    for (const auto& t : mesh.triangles) {
        const Eigen::Vector3d u = mesh.positions[static_cast<std::size_t>(t[1])] -
                                  mesh.positions[static_cast<std::size_t>(t[0])];
        const Eigen::Vector3d v = mesh.positions[static_cast<std::size_t>(t[2])] -
                                  mesh.positions[static_cast<std::size_t>(t[0])];
        sum += 0.5 * std::sqrt(u.squaredNorm() * v.squaredNorm() - std::pow(u.dot(v), 2));
    }
    return sum;
}

}  // namespace leafcutter::testing
