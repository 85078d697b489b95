// Exact distances between outlines, sped up by a grid of edges.

#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "fab/nest/shape.h"

namespace leafcutter::fab {

struct Segment {
    Eigen::Vector2d from;
    Eigen::Vector2d to;
};

double squared_distance(const Eigen::Vector2d& point, const Segment& segment);
double squared_distance(const Segment& a, const Segment& b);  // 0 if they cross.
bool contains(const Ring& ring, const Eigen::Vector2d& point);

// The outlines that lie on one sheet.
class PlacedOutlines {
public:
    explicit PlacedOutlines(const Eigen::Vector2d& extent, double cell_mm = 12.0);

    void add(const Ring& ring);

    // Whether `ring`, moved by `shift`, comes closer than `gap_mm` to an outline or overlaps it.
    bool collides(const Ring& ring, const Eigen::Vector2d& shift, double gap_mm) const;

    // Distance from `ring` to the nearest outline; 0 if they overlap; at most `limit_mm`.
    double distance(const Ring& ring, double limit_mm) const;

    std::size_t size() const { return rings_.size(); }

private:
    struct Range {
        int x0 = 0;
        int x1 = 0;
        int y0 = 0;
        int y1 = 0;
    };
    Range cells_near(const Segment& segment, double reach_mm) const;
    double least_square(const Segment& segment, double limit_square) const;
    bool overlaps_wholly(const Ring& ring, const Eigen::Vector2d& shift) const;

    double cell_mm_;
    int columns_;
    int rows_;
    std::vector<std::vector<std::size_t>> cells_;
    std::vector<Segment> segments_;
    std::vector<Ring> rings_;
    std::vector<Box> boxes_;
};

}  // namespace leafcutter::fab
