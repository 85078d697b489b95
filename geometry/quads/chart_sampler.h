// From (g, f) to the surface: point location in a chart by uniform bins.

#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "geometry/foliation.h"

namespace leafcutter::geometry {

class ChartSampler {
public:
    // Refers to `chart`, which must outlive the sampler.
    explicit ChartSampler(const Cylinder& chart);

    // The point of the surface at (g, f); f in [0, height] but for a torus, any g but for a
    // rectangle. Where rounding leaves a point in no triangle, the one it misses least takes it,
    // clamped: a point on the chart's boundary comes out on the surface's boundary.
    Eigen::Vector3d point(const Eigen::Vector2d& gf) const;

private:
    // A triangle moved by whole periods so that it meets the fundamental domain.
    struct Copy {
        int triangle = 0;
        Eigen::Vector2d shift = Eigen::Vector2d::Zero();
    };
    // The copy that contains a point best: by its smallest barycentric coordinate.
    struct Candidate {
        int triangle = -1;
        Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
    };

    Eigen::Vector2d reduced(Eigen::Vector2d gf) const;
    std::vector<Copy> copies_of(int triangle) const;
    std::size_t bin(int column, int row) const;
    int bin_column(double g) const;
    int bin_row(double f) const;
    void look_in_bin(std::size_t bin, const Eigen::Vector2d& gf, Candidate& best) const;

    const Cylinder& chart_;
    int columns_ = 1;
    int rows_ = 1;
    std::vector<std::size_t> bin_starts_;  // Per bin its first entry in `entries_`, and the end.
    std::vector<Copy> entries_;
};

}  // namespace leafcutter::geometry
