// Where the rectangles of a one-form meet: along leaves of F* through its zeros, as seen from both
// sides, and which of their leaves of F go on into which.
//
// The one-form names every vertex on a flank of a rectangle (Cylinder::critical_point). Flanks are
// parted at zeros; sides with the same points are the same. Between the levels of two zeros leaves
// of F change nothing but their place: those that are connected there are a band.

#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "geometry/foliation.h"

namespace leafcutter::geometry {

// A leaf of F* from stop to stop: a zero, or the end on a source or sink.
struct CriticalSide {
    std::vector<int> points;  // Into Foliation::critical_points, f rising.
    std::vector<double> f;    // Of the points: the mean of what both rectangles say.
    int left = -1;            // Cylinders on both sides, -1 beyond the boundary of the surface.
    int right = -1;
};

struct SideUse {
    int side = 0;
    std::size_t first = 0;  // Into the flank's vertices; the next use, or the flank's end, ends it.
};

struct Flank {
    std::vector<int> vertices;  // Of the chart, f rising from 0 to the height.
    std::vector<double> f;      // Per vertex, as the sides have it.
    std::vector<SideUse> uses;
};

// Connected leaves of F, between two zeros or a zero and a loop.
struct FormBand {
    int lower = -1;      // Place in SideNetwork::zeros, -1 for a source,
    int upper = -1;      // -1 for a sink.
    bool closed = true;  // Rings; else they end on the boundary of the surface.
    std::vector<int> cylinders;
};

struct FormZeroPlace {
    int point = 0;  // Into Foliation::critical_points.
    double f = 0.0;
};

struct SideNetwork {
    enum Flanks : std::size_t { Left, Right };  // g = 0, g = width.

    std::vector<int> cylinders;                // Those that are rectangles with neighbours.
    std::vector<std::array<Flank, 2>> flanks;  // Per cylinder of the foliation.
    std::vector<std::array<std::vector<int>, 2>> ends;  // Vertices at f = 0 and f = height, g
                                                        // rising.
    std::vector<CriticalSide> sides;
    std::vector<FormZeroPlace> zeros;  // By rising f.
    std::vector<FormBand> bands;
    // Per cylinder its band below the first zero, between it and the second, and so on.
    std::vector<std::vector<int>> band_at;

    // The place of a critical point in `zeros`, or -1.
    int zero_of(int point) const { return zero_of_point[static_cast<std::size_t>(point)]; }
    std::vector<int> zero_of_point;
};

// Throws Error(SelfCheck, "critical-sides") unless every side has the same points from both sides,
// and f rises along all of them.
SideNetwork find_sides(const Foliation& foliation);

// The point of a side where f is so high.
Eigen::Vector3d point_on(const CriticalSide& side, const Foliation& foliation, double f);

}  // namespace leafcutter::geometry
