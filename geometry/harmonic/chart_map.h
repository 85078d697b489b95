// A surface on its way to a Cylinder: vertices with their coordinates (g, f), x = g and y = f.
//
// Where the chart has periods the coordinates of a vertex are one of its lifts, and `jump` says by
// how much the lift goes on along a half-edge: its difference is gf[to] - gf[from] + jump.

#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "geometry/foliation.h"
#include "geometry/half_edges.h"
#include "geometry/harmonic/chart_surface.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

struct ChartMap {
    TriangleMesh mesh;
    HalfEdges edges;
    std::vector<int> source_vertex;
    std::vector<Eigen::Vector2d> gf;    // Per vertex.
    std::vector<Eigen::Vector2d> jump;  // Per half-edge, antisymmetric; empty for a rectangle.

    ChartShape shape = ChartShape::Rectangle;
    double width = 0.0;
    double height = 0.0;
    double shear = 0.0;

    Eigen::Vector2d difference(int half_edge) const {
        Eigen::Vector2d rise = gf[static_cast<std::size_t>(edges.to_of(half_edge))] -
                               gf[static_cast<std::size_t>(edges.from_of(half_edge))];
        if (!jump.empty()) {
            rise += jump[static_cast<std::size_t>(half_edge)];
        }
        return rise;
    }
};

// A map of `surface` with coordinates yet to be set.
ChartMap start_chart(const ChartSurface& surface);

// The map that a finished cylinder came from, but for lifts: to change its coordinates.
ChartMap reopen_chart(const Cylinder& cylinder);

// (g, f) of the corners of a triangle, lifted continuously from its first corner.
std::array<Eigen::Vector2d, 3> lifted_corners(const ChartMap& map, int triangle);

// Triangles that are not positive in (g, f), or flat but for rounding.
std::vector<int> bad_triangles(const ChartMap& map);

// Area of the whole chart in (g, f).
double chart_area(const ChartMap& map);

// Moves every vertex's lift into the fundamental domain: f in [0, height) on a torus, g in [0,
// width) after its shear. Changes nothing else.
void lift_into_domain(ChartMap& map);

// The finished cylinder; energy and gap are left to the caller.
// Throws Error(SelfCheck, "chart-not-bijective") unless every triangle is positive and together
// they cover the chart exactly once.
Cylinder finish_cylinder(ChartMap map);

}  // namespace leafcutter::geometry
