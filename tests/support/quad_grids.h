// Quad meshes made by formulas: one chart, sampled at grid points (g, f) in [0, 1] x [0, 1].

#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <Eigen/Core>

#include "geometry/quads/quad_mesh.h"

namespace leafcutter::test {

struct GridSize {
    int rows = 0;
    int cols = 0;
};

using Surface = std::function<Eigen::Vector3d(double g, double f)>;

inline geometry::QuadMesh quad_grid(const GridSize& size,
                                    geometry::ChartShape shape,
                                    const Surface& surface) {
    using geometry::ChartShape;
    const int across = shape == ChartShape::Rectangle ? size.cols + 1 : size.cols;
    const int up = shape == ChartShape::Torus ? size.rows : size.rows + 1;
    geometry::QuadMesh mesh;
    for (int i = 0; i < up; ++i) {
        for (int j = 0; j < across; ++j) {
            mesh.vertices.push_back(surface(double(j) / size.cols, double(i) / size.rows));
        }
    }
    const auto vertex = [&](int i, int j) { return (i % up) * across + j % across; };
    for (int i = 0; i < size.rows; ++i) {
        for (int j = 0; j < size.cols; ++j) {
            mesh.quads.push_back(
                {vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j)});
            mesh.addresses.push_back({0, i, j});
            mesh.surface_area.push_back(1.0);
        }
    }
    geometry::CylinderGrid grid;
    grid.shape = shape;
    grid.rows = size.rows;
    grid.cols = size.cols;
    mesh.grids.push_back(grid);
    return mesh;
}

inline geometry::QuadMesh flat_grid(const GridSize& size, double width_mm) {
    return quad_grid(size, geometry::ChartShape::Rectangle, [=](double g, double f) {
        return Eigen::Vector3d(g * size.cols * width_mm, f * size.rows * width_mm, 0.0);
    });
}

inline geometry::QuadMesh cylinder_grid(const GridSize& size, double radius_mm, double height_mm) {
    return quad_grid(size, geometry::ChartShape::Annulus, [=](double g, double f) {
        const double angle = 2.0 * std::numbers::pi * g;
        return Eigen::Vector3d(radius_mm * std::cos(angle), radius_mm * std::sin(angle),
                               height_mm * f);
    });
}

// Rings of f run around the tube, columns of g around the hole.
inline geometry::QuadMesh torus_grid(const GridSize& size, double radius_mm, double tube_mm) {
    return quad_grid(size, geometry::ChartShape::Torus, [=](double g, double f) {
        const double u = 2.0 * std::numbers::pi * f;
        const double v = -2.0 * std::numbers::pi * g;
        const double r = radius_mm + tube_mm * std::cos(v);
        return Eigen::Vector3d(r * std::cos(u), r * std::sin(u), tube_mm * std::sin(v));
    });
}

// A sheet with hills of the given height, and columns whose widths differ 100-fold.
inline geometry::QuadMesh bumpy_grid(const GridSize& size, double width_mm, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-0.25, 0.25);
    geometry::QuadMesh mesh = flat_grid(size, width_mm);
    for (Eigen::Vector3d& p : mesh.vertices) {
        const double x = p.x() / (size.cols * width_mm);
        p.x() = size.cols * width_mm * (0.02 * x + 0.98 * x * x * x);
        const double local = 0.02 + 0.98 * 3.0 * x * x;
        p += width_mm * local * Eigen::Vector3d(uniform(random), uniform(random), 0.0);
        p.z() = 2.0 * width_mm * std::sin(p.x() / width_mm) * std::cos(p.y() / width_mm);
    }
    return mesh;
}

}  // namespace leafcutter::test
