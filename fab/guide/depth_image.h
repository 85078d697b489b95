// Which quad lies nearest at each pixel of a parallel projection.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab::guide {

class DepthImage {
public:
    // `projected` are the mesh's vertices: x right, y down, z towards the viewer. The longer side
    // gets `pixels` of them.
    DepthImage(const std::vector<std::array<int, 4>>& quads,
               const std::vector<Eigen::Vector3d>& projected,
               int pixels);

    // Calls `visit(nearest quad)` for every pixel whose centre lies in `quad`, which itself is
    // nearest where nothing hides it.
    template <typename Visit>
    void for_each_pixel(int quad, const Visit& visit) const {
        rasterise(quad, [&](std::size_t pixel, double) { visit(nearest_[pixel]); });
    }

    double pixel_size() const { return pixel_; }
    const std::vector<int>& nearest() const { return nearest_; }  // -1: none.

private:
    template <typename Visit>
    void rasterise(int quad, const Visit& visit) const {
        const auto& corners = quads_[static_cast<std::size_t>(quad)];
        triangle({corners[0], corners[1], corners[2]}, visit);
        triangle({corners[0], corners[2], corners[3]}, visit);
    }

    template <typename Visit>
    void triangle(const std::array<int, 3>& corners, const Visit& visit) const;

    const std::vector<std::array<int, 4>>& quads_;
    std::vector<Eigen::Vector3d> points_;  // In pixels; depth in units of the mesh.
    int width_ = 0;
    int height_ = 0;
    double pixel_ = 1.0;
    std::vector<int> nearest_;
};

template <typename Visit>
void DepthImage::triangle(const std::array<int, 3>& corners, const Visit& visit) const {
    const Eigen::Vector3d& a = points_[static_cast<std::size_t>(corners[0])];
    const Eigen::Vector3d& b = points_[static_cast<std::size_t>(corners[1])];
    const Eigen::Vector3d& c = points_[static_cast<std::size_t>(corners[2])];
    const double area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (std::abs(area) < 1e-12) {
        return;
    }
    const auto first = [](double value) { return std::max(0, static_cast<int>(std::ceil(value))); };
    const auto last = [](double value, int size) {
        return std::min(size - 1, static_cast<int>(std::floor(value)));
    };
    const int y_end = last(std::max({a.y(), b.y(), c.y()}), height_);
    const int x_end = last(std::max({a.x(), b.x(), c.x()}), width_);
    for (int y = first(std::min({a.y(), b.y(), c.y()})); y <= y_end; ++y) {
        for (int x = first(std::min({a.x(), b.x(), c.x()})); x <= x_end; ++x) {
            const double u = ((c.x() - b.x()) * (y - b.y()) - (c.y() - b.y()) * (x - b.x())) / area;
            const double v = ((a.x() - c.x()) * (y - c.y()) - (a.y() - c.y()) * (x - c.x())) / area;
            const double w = 1.0 - u - v;
            if (u >= 0.0 && v >= 0.0 && w >= 0.0) {
                visit(static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                          static_cast<std::size_t>(x),
                      u * a.z() + v * b.z() + w * c.z());
            }
        }
    }
}

}  // namespace leafcutter::fab::guide
